/* render/radar/signatures.h: fields of targets, kept for reuse: one for each model, pose of its parts, damage, and
 * bin of aspect.
 *
 * A field (total_field.h: ray tubes and edges) is made for the middle of its bin, so what is kept and when it was
 * made change no bit: for an antenna elsewhere in the bin it follows by the change of each path (field.h,
 * centres.h). Bins are aspect_rad wide in elevation and about as wide across, and a factor of 2^(1/4) in range.
 * Error at the edge of a bin of 0.3 degrees: -54 dB at 0.1 degrees, -48 dB at 0.3 (tests/render/test_radar_field.c).
 * Wheels do not turn in them: one would not be met twice. The least recently used make room for others. */
#ifndef RENDER_RADAR_SIGNATURES_H
#define RENDER_RADAR_SIGNATURES_H

#include "entities/catalog/catalog.h"
#include "render/radar/total_field.h"

typedef struct SignatureConfig {
    double      frequency_hz;        /* centre of the band */
    double      aspect_rad;          /* side of a bin */
    double      rays_per_wavelength;
    int         splits;              /* of tubes at edges (tubes.h); 0: fastest */
    double      warp_m;              /* unevenness of surfaces (warp.h), rms; 0: plane as the model has them */
    size_t      most_octets;         /* of all; the one in use is kept beyond it */
    const char *isa;                 /* as tracer_create */
} SignatureConfig;

typedef struct SignatureCounters {
    uint64_t made, reused, dropped, rays;
    double   spent_s; /* wall clock, making them */
} SignatureCounters;

typedef struct Signatures Signatures;

/* catalog, materials: must outlive it. */
Status signatures_create(Signatures **out, const SignatureConfig *config, const Catalog *catalog,
                         const RadarMaterials *materials);
void   signatures_destroy(Signatures *signatures); /* accepts NULL */
/* The field of a model of the catalog for an antenna in its frame; valid until the next call. joint: values of its
 * joints (snapshot_pose), NULL: at rest. One thread at a time; pool may be NULL. */
Status signatures_find(const TotalField **out, Signatures *signatures, int model, const double *joint, int damage,
                       const ScatterAntenna *antenna, Pool *pool);
/* The model as it is posed in the field found last. */
const RadarTarget *signatures_target(const Signatures *signatures);
const SignatureCounters *signatures_counters(const Signatures *signatures);

/* The middle of the bin that an antenna is in. */
void signature_bin(ScatterAntenna *middle, const ScatterAntenna *antenna, double aspect_rad);

#endif
