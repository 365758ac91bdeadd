/* XDMF indices of HDF5 recordings, as ParaView and VisIt read them: one grid a sample, of the body's faces, edges or
 * loose points, with the velocities on them.
 *
 * Owns: the index's text. Called by recording_hdf5.c. */
#ifndef SKEIN_IO_XDMF_H
#define SKEIN_IO_XDMF_H

#include "io/file.h"

typedef struct io_xdmf {
    size_t particles;
    size_t cell_count;  /* 0: points */
    uint32_t cell_size; /* 2 edges, 3 triangles, 4 quadrilaterals; 0: mixed */
    size_t cell_length; /* of the mixed ones' numbers */
    double *times;      /* samples */
    size_t samples;
} io_xdmf;

/* The set in the HDF5 file that has the cells. */
const char *io_xdmf_cells_name(const io_xdmf *index);
/* NAME.xdmf of NAME.h5, to be freed; NULL without memory. */
char *io_xdmf_path(const char *h5_path);
/* The HDF5 file is named without its folder. */
void io_xdmf_write(io_output *output, const io_xdmf *index, const char *h5_path);

#endif
