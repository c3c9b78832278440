/* render/trace/parts/parts_packet_private.h: rays side by side: of a block, in a node's axes, and in a packet for
 * Embree. */
#ifndef RENDER_TRACE_PARTS_PARTS_PACKET_PRIVATE_H
#define RENDER_TRACE_PARTS_PARTS_PACKET_PRIVATE_H

#include "render/trace/parts/parts_private.h"

#include "pitviper_simd.h"

enum { lanes = 16, ties_kept = 8, chunk_rays = 128 };

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

typedef struct Vector {
    F64x4 x, y, z;
} Vector;

static inline Vector load3(const double *x, const double *y, const double *z)
{
    return (Vector){f64x4_load(x), f64x4_load(y), f64x4_load(z)};
}
static inline Vector set3(const double p[3]) { return (Vector){f64x4_set(p[0]), f64x4_set(p[1]), f64x4_set(p[2])}; }
static inline Vector sub(Vector a, Vector b) { return (Vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vector add_scaled(Vector a, F64x4 s, Vector b)
{
    return (Vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline F64x4  dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vector cross(Vector a, Vector b)
{
    return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/* transpose(m) a */
static inline Vector turned_back(const double m[9], Vector a)
{
    return (Vector){f64x4_set(m[0]) * a.x + f64x4_set(m[3]) * a.y + f64x4_set(m[6]) * a.z,
                    f64x4_set(m[1]) * a.x + f64x4_set(m[4]) * a.y + f64x4_set(m[7]) * a.z,
                    f64x4_set(m[2]) * a.x + f64x4_set(m[5]) * a.y + f64x4_set(m[8]) * a.z};
}

/* Rays close together, from a block's; filled up to a multiple of four. */
typedef struct Chunk {
    double o[3][chunk_rays], d[3][chunk_rays];
    double best_m[chunk_rays]; /* search limit */
    int    ray[chunk_rays];    /* of the block */
    int    count;
} __attribute__((aligned(64))) Chunk;

/* In a node's axes, each from where it enters the node's sphere. */
typedef struct NodeRays {
    double   o[3][chunk_rays], d[3][chunk_rays];
    double   start_m[chunk_rays], length_m[chunk_rays]; /* of o along the ray as given; through the sphere */
    unsigned meets[chunk_rays / 4]; /* 1 << lane in four: hits the node's sphere and box, ahead and before best_m */
} __attribute__((aligned(64))) NodeRays;

/* Rays of a node side by side, and their results. */
typedef struct Packet {
    struct RTCIntersectContext base; /* first: Embree passes it to the callback */
    const NodeMesh            *mesh;
    bool                       lowest_only; /* second pass, collects into `lowest`: nearest_m is known */
    int                        count;
    double                     o[3][lanes] __attribute__((aligned(64))), d[3][lanes];
    double                     start_m[lanes], length_m[lanes];
    double                     far_m[lanes];     /* search limit */
    double                     nearest_m[lanes]; /* of those passed through */
    float                      end_m[lanes];     /* Embree's limit */
    int                        ties[lanes];
    bool                       crowded[lanes];        /* more than were stored */
    uint32_t                   tie[lanes][ties_kept]; /* of the node, at nearest_m and somewhat beyond */
    double                     tie_m[lanes][ties_kept];
    uint32_t                   lowest[lanes];
    double                     lowest_m[lanes];
    uint32_t                   nearest[lanes]; /* the triangle at nearest_m; of equals any */
    int                        ray[lanes];     /* of the chunk */
} __attribute__((aligned(64))) Packet;

static inline void packet_open(Packet *p, const NodeMesh *mesh)
{
    rtcInitIntersectContext(&p->base); /* never COHERENT: rtcOccluded16 of 3.13 may then not return under AVX-512 */
    p->mesh = mesh;
    p->lowest_only = false;
    p->count = 0;
}

static inline void packet_add(Packet *p, const NodeRays *r, int i, double best_m)
{
    const int l = p->count++;
    for (int c = 0; c < 3; c++) {
        p->o[c][l] = r->o[c][i];
        p->d[c][l] = r->d[c][i];
    }
    p->start_m[l] = r->start_m[i];
    p->length_m[l] = r->length_m[i];
    p->far_m[l] = best_m - r->start_m[i];
    p->nearest_m[l] = INFINITY;
    p->ties[l] = 0;
    p->crowded[l] = false;
    p->ray[l] = i;
}

/* Traces the packet in its node and empties it. range_m, hit: of the block's rays that meet something nearer.
 * one_by_one: its rays are traced singly, to the same result. */
void packet_first_hits(double *range_m, PartHit *hit, Packet *p, Chunk *chunk, int node, bool one_by_one);
/* met becomes 1 for the block's rays that meet anything. */
void packet_any_hits(uint8_t *met, Packet *p, const Chunk *chunk, bool alone);

#endif
