/* XDMF indices: see xdmf.h. */
#include "io/xdmf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *io_xdmf_cells_name(const io_xdmf *index) {
    return index->cell_size == 2 ? "edges" : "faces";
}

char *io_xdmf_path(const char *h5_path) {
    size_t length = strlen(h5_path);
    char *path = malloc(length + sizeof ".xdmf");
    if (length > 3 && !strcmp(h5_path + length - 3, ".h5")) length -= 3;
    if (path) snprintf(path, length + sizeof ".xdmf", "%.*s.xdmf", (int)length, h5_path);
    return path;
}

/* A name in an attribute or a text. */
static void write_escaped(io_output *output, const char *text) {
    for (; *text; text++) {
        const char *entity = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        if (entity) io_output_write(output, entity, strlen(entity));
        else io_output_write(output, text, 1);
    }
}

static void write_topology(io_output *output, const io_xdmf *x, const char *name) {
    static const char *const types[] = {"Mixed", "", "Polyline", "Triangle", "Quadrilateral"};
    if (!x->cell_count) {
        io_output_printf(output,
                         "        <Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" "
                         "NumberOfElements=\"%zu\"/>\n",
                         x->particles);
        return;
    }
    io_output_printf(output, "        <Topology TopologyType=\"%s\" NumberOfElements=\"%zu\"", types[x->cell_size],
                     x->cell_count);
    if (x->cell_size == 2) io_output_printf(output, " NodesPerElement=\"2\"");
    if (x->cell_size)
        io_output_printf(output, ">\n          <DataItem Dimensions=\"%zu %u\"", x->cell_count, x->cell_size);
    else io_output_printf(output, ">\n          <DataItem Dimensions=\"%zu\"", x->cell_length);
    io_output_printf(output, " NumberType=\"UInt\" Precision=\"4\" Format=\"HDF\">");
    write_escaped(output, name);
    io_output_printf(output, ":/%s</DataItem>\n        </Topology>\n", io_xdmf_cells_name(x));
}

/* A part of a set: sample `k` of all. */
static void write_item(io_output *output, const io_xdmf *x, const char *name, const char *set, size_t k) {
    io_output_printf(output,
                     "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"%zu 3\">\n"
                     "            <DataItem Dimensions=\"3 3\" Format=\"XML\">%zu 0 0 1 1 1 1 %zu 3</DataItem>\n"
                     "            <DataItem Dimensions=\"%zu %zu 3\" NumberType=\"Float\" Precision=\"%zu\" "
                     "Format=\"HDF\">",
                     x->particles, k, x->particles, x->samples, x->particles, sizeof(skein_real));
    write_escaped(output, name);
    io_output_printf(output, ":/%s</DataItem>\n          </DataItem>\n", set);
}

void io_xdmf_write(io_output *output, const io_xdmf *x, const char *h5_path) {
    const char *slash = strrchr(h5_path, '/'), *name = slash ? slash + 1 : h5_path;
    io_output_printf(output, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
                             "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
    for (size_t k = 0; k < x->samples; k++) {
        io_output_printf(output, "      <Grid Name=\"particles\">\n        <Time Value=\"%.17g\"/>\n", x->times[k]);
        write_topology(output, x, name);
        io_output_printf(output, "        <Geometry GeometryType=\"XYZ\">\n");
        write_item(output, x, name, "positions", k);
        io_output_printf(output, "        </Geometry>\n        <Attribute Name=\"velocity\" "
                                 "AttributeType=\"Vector\" Center=\"Node\">\n");
        write_item(output, x, name, "velocities", k);
        io_output_printf(output, "        </Attribute>\n      </Grid>\n");
    }
    io_output_printf(output, "    </Grid>\n  </Domain>\n</Xdmf>\n");
}
