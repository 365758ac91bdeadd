/* Recording by all ranks at once: each appends what is its own after a frame to a file of its own, and the leader an index of
 * them all, XDMF, that is whole after every frame.
 *
 *   FOLDER/rank-R.bin   of each frame: numbers in the whole run (n x uint32), positions and velocities (n x 3 reals each)
 *   FOLDER.xdmf         of each frame where those of each rank begin, and how many there are */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "ranks/shared_inside.h"

enum { NAME_SIZE = 4096 };

static const char end_of_index[] = "  </Grid>\n </Domain>\n</Xdmf>\n";

typedef struct shared_place {
    uint64_t at, count;
} shared_place;

static _Noreturn void fail(const shared_run *run, const char *name) {
    char words[NAME_SIZE + 200];
    snprintf(words, sizeof words, "%s cannot be written: %s", name, strerror(errno));
    shared_give_up(run, words);
}

void shared_record_open(shared_run *run, const char *folder) {
    char own[NAME_SIZE] = "", *all = malloc((size_t)run->count * NAME_SIZE);
    if (!all) shared_give_up(run, "out of memory");
    if (folder) snprintf(own, sizeof own, "%s", folder);
    run->ranks->gather(own, sizeof own, all);
    snprintf(run->parts.folder, sizeof run->parts.folder, "%s", all);
    snprintf(own, sizeof own, "%.4000s/rank-%d.bin", all, run->rank);
    free(all);
    run->parts.data = fopen(own, "wb");
    if (!run->parts.data) fail(run, own);
    if (run->rank) return;
    snprintf(own, sizeof own, "%.4000s.xdmf", run->parts.folder);
    run->parts.index = fopen(own, "wb");
    if (!run->parts.index || fputs("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
                                   "  <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
                                   run->parts.index) < 0)
        fail(run, own);
}

/* Appends its own; where they begin, and how many there are. */
static shared_place append(shared_run *run) {
    FILE *file = run->parts.data;
    shared_place place = {(uint64_t)ftello(file), 0};
    const skein_state state = shared_state(run);
    bool good = true;
    for (int pass = 0; pass < 3; pass++)
        for (size_t b = 0; b < run->body_count; b++)
            for (size_t i = run->bodies[b].first; i < run->bodies[b].first + run->bodies[b].own; i++) {
                const skein_real *of = pass == 1 ? state.position[state.slot_of[i]] : state.velocity[state.slot_of[i]];
                good &= pass ? fwrite(of, sizeof *of, 3, file) == 3
                             : fwrite(&run->number[i], sizeof *run->number, 1, file) == 1;
                place.count += pass == 0;
            }
    if (!good || fflush(file)) fail(run, "a rank's part of a frame");
    return place;
}

static void put_item(FILE *to, const char *name, int rank, const char *type, size_t size, int columns, uint64_t at,
                     uint64_t count) {
    const char *order = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? "Little" : "Big";
    fprintf(to,
            "      <DataItem Format=\"Binary\" NumberType=\"%s\" Precision=\"%zu\" Endian=\"%s\" Seek=\"%" PRIu64
            "\" Dimensions=\"%" PRIu64 "%s\">%s/rank-%d.bin</DataItem>\n",
            type, size, order, at, count, columns == 3 ? " 3" : "", name, rank);
}

/* One more frame of the index, and what ends it, over which the next is written. */
static void put_frame(shared_run *run, double time, const shared_place *places) {
    FILE *to = run->parts.index;
    const char *slash = strrchr(run->parts.folder, '/'), *name = slash ? slash + 1 : run->parts.folder;
    fprintf(to,
            "   <Grid Name=\"frame\" GridType=\"Collection\" CollectionType=\"Spatial\">\n    <Time Value=\"%.17g\"/>\n",
            time);
    for (int r = 0; r < run->count; r++) {
        uint64_t n = places[r].count, at = places[r].at;
        if (!n) continue;
        fprintf(to,
                "    <Grid Name=\"rank %d\">\n     <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%" PRIu64
                "\"/>\n",
                r, n);
        fprintf(to, "     <Geometry GeometryType=\"XYZ\">\n");
        put_item(to, name, r, "Float", sizeof(skein_real), 3, at + 4 * n, n);
        fprintf(to, "     </Geometry>\n     <Attribute Name=\"number\" AttributeType=\"Scalar\" Center=\"Node\">\n");
        put_item(to, name, r, "UInt", sizeof(uint32_t), 1, at, n);
        fprintf(to, "     </Attribute>\n     <Attribute Name=\"velocity\" AttributeType=\"Vector\" Center=\"Node\">\n");
        put_item(to, name, r, "Float", sizeof(skein_real), 3, at + 4 * n + 3 * sizeof(skein_real) * n, n);
        fprintf(to, "     </Attribute>\n    </Grid>\n");
    }
    fprintf(to, "   </Grid>\n");
    off_t end = ftello(to);
    if (fputs(end_of_index, to) < 0 || fflush(to) || end < 0 || fseeko(to, end, SEEK_SET))
        fail(run, "the index of ranks' files");
}

void shared_record_frame(shared_run *run, double time) {
    shared_place own = append(run), *all = malloc((size_t)run->count * sizeof *all);
    if (!all) shared_give_up(run, "out of memory");
    run->ranks->gather(&own, sizeof own, all);
    if (!run->rank) put_frame(run, time, all);
    free(all);
}

void shared_record_close(shared_run *run) {
    FILE *files[] = {run->parts.data, run->parts.index};
    for (int i = 0; i < 2; i++)
        if (files[i] && fclose(files[i]))
            fprintf(stderr, "skein: rank %d: its part of the recording: %s\n", run->rank, strerror(errno));
    run->parts.data = run->parts.index = NULL;
}
