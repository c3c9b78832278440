/* terrain/store/store_albedo.c: rows of a photograph, south first, to blocks and mips. */
#include "terrain/store/store_write_private.h"

#include "terrain/landscape/photo.h"

#include <stdlib.h>

Status store_albedo_begin(StoreWriter *w)
{
    const Photo *p = &w->photo;
    for (int k = 0; k < p->mips; k++) {
        w->mip[k].row = malloc(16 * (size_t)p->nx[k]);
        if (!w->mip[k].row) return STATUS_NO_MEMORY;
    }
    w->halved = p->mips ? malloc(4 * (size_t)p->nx[0]) : NULL;
    return p->mips && !w->halved ? STATUS_NO_MEMORY : STATUS_OK;
}

void store_albedo_end(StoreWriter *w)
{
    for (int k = 0; k < ground_image_mips; k++) free(w->mip[k].row);
    free(w->halved);
}

enum { piece_blocks = 128 };

typedef struct BlocksJob {
    const uint8_t *rgba;
    PhotoBlock    *to;
    int            nx, rows;
} BlocksJob;

/* Pieces of a row of blocks: copied together, as photo_block_row takes whole rows. */
static void encode_piece(void *user, int worker, int task)
{
    (void)worker;
    const BlocksJob *job = user;
    uint8_t          some[4][4 * 4 * piece_blocks];
    const int        i0 = task * 4 * piece_blocks, left = job->nx - i0;
    const int        nx = left < 4 * piece_blocks ? left : 4 * piece_blocks;
    for (int j = 0; j < job->rows; j++)
        memcpy((uint8_t *)some + (size_t)j * 4 * (size_t)nx, job->rgba + 4 * ((size_t)j * (size_t)job->nx + (size_t)i0),
               4 * (size_t)nx);
    photo_block_row(job->to + i0 / 4, (const uint8_t *)some, nx, job->rows);
}

/* A row of mip 0, and with it a row of each mip that has become whole. The rows of mip k are in `rgba`; those of the
 * next in w->halved, which is free again once they are copied. */
static void add_row(StoreWriter *w, int k, const uint8_t *rgba)
{
    const Photo *p = &w->photo;
    for (; k < p->mips; k++) {
        MipRows     *m = &w->mip[k];
        const int    nx = p->nx[k], in = m->done % 4;
        const size_t row = 4 * (size_t)nx;
        memcpy(m->row + (size_t)in * row, rgba, row);
        m->done++;
        const bool last = m->done == p->ny[k];
        if (in == 3 || last) {
            BlocksJob job = {m->row, p->block[k] + (size_t)((m->done - 1) / 4) * photo_blocks_across(nx), nx, in + 1};
            store_run(w->pool, (nx + 4 * piece_blocks - 1) / (4 * piece_blocks), encode_piece, &job);
        }
        if (in % 2 == 0 && !last) return;
        photo_halve_row(w->halved, m->row + (size_t)(in - in % 2) * row, in % 2 ? m->row + (size_t)in * row : NULL, nx);
        rgba = w->halved;
    }
}

Status store_write_albedo(StoreWriter *w, int rows, const uint8_t *rgba)
{
    const Photo *p = &w->photo;
    if (rows < 0 || p->mips == 0 || rows > p->ny[0] - w->mip[0].done) {
        log_error("store: %s: too many rows of the photograph", w->path);
        return STATUS_BAD_VALUE;
    }
    for (int j = 0; j < rows; j++) add_row(w, 0, rgba + (size_t)j * 4 * (size_t)p->nx[0]);
    return STATUS_OK;
}
