/* render/scattering/signatures/signatures.h: signatures of targets, kept for reuse: one for each model, pose of its
 * parts, damage, and bins of the transmitter's and the receiver's aspect (and of the ground, where one of them is
 * an image in it).
 *
 * A signature (signature.h) is made for the middle of its bin, so neither what is kept, nor when or where it was made,
 * changes a bit: for antennas elsewhere in the bin it follows by the change of each path (centres.h). Bins are
 * aspect_rad wide in elevation and about as wide across, and a factor of 2^(1/4) in range. Wheels do not turn in
 * them: one would not be met twice. The least recently used make room for others.
 *
 * One that is not at hand is fetched from a store (a library on disk), else made, and given to the store. With
 * `background` it is made in a thread of its own, newest request first, and until then there is none; what is prepared
 * (signatures_prepare) comes after all requests. Coarse ones (coarse.h) are of wide bins, whatever the range. */
#ifndef RENDER_SCATTERING_SIGNATURES_SIGNATURES_H
#define RENDER_SCATTERING_SIGNATURES_SIGNATURES_H

#include "entities/catalog/catalog.h"
#include "render/scattering/signatures/bins.h"
#include "render/scattering/signatures/centres.h"

/* What a signature is of. */
typedef struct SignatureKey {
    const Model  *model;
    const double *joint; /* [node_count]; wheels at 0 */
    int           damage;
    SignatureLook look; /* of the bins' middles */
} SignatureKey;

typedef struct SignatureStore {
    void *user;
    /* False: it has none. */
    bool (*fetch)(void *user, Signature *out, const SignatureKey *key);
    /* From any thread. */
    void (*keep)(void *user, const Signature *signature, const SignatureKey *key);
} SignatureStore;

typedef struct SignaturesConfig {
    double         frequency_hz, bandwidth_hz; /* centre of the band, and the band */
    double         aspect_rad;                 /* side of a bin */
    double         interval_s;                 /* SignatureCells */
    double         rays_per_wavelength;
    int            splits;        /* of tubes at edges (tubes.h); 0: fastest */
    double         warp_m;        /* unevenness of surfaces (tubes.h), rms; 0: plane as the model has them */
    size_t         most_octets;   /* of all; the one in use is kept beyond it */
    double         coarse_for_hz; /* coarse.h: the frequency that these are coarse ones for; 0: they are fine */
    bool           background;
    int            nice;  /* of the background's thread, 0 .. 19 */
    SignatureStore store; /* fetch NULL: none */
    const char    *isa;   /* as tracer_create */
} SignaturesConfig;

typedef struct SignatureCounters {
    uint64_t made, fetched, reused, dropped, missing,
        rays;       /* missing: how often a signature was asked for that was still to be made */
    double spent_s; /* wall clock, making them */
} SignatureCounters;

typedef struct Signatures Signatures;

/* The configuration of the coarse signatures (coarse.h) of a radar whose fine ones are these: without a store. */
SignaturesConfig signatures_coarse(const SignaturesConfig *fine);
/* catalog, materials, and the store's: must outlive it. */
Status signatures_create(Signatures **out, const SignaturesConfig *config, const Catalog *catalog,
                         const RadarMaterials *materials);
void   signatures_destroy(Signatures *signatures); /* accepts NULL; waits for the one that is being made */
/* The signature of a model of the catalog for antennas in its frame; valid until the next call. joint: values of its
 * joints (snapshot_pose), NULL: at rest. *out NULL: it is being made in the background. One thread at a time; pool may
 * be NULL. */
Status signatures_find(const Signature **out, Signatures *signatures, int model, const double *joint, int damage,
                       const SignatureLook *look, Pool *pool);
/* Pose of the nodes in the signature found last, body axes. */
const NodePose   *signatures_pose(const Signatures *signatures);
SignatureCounters signatures_counters(const Signatures *signatures);
/* Those that are to be made in the background. */
int signatures_waiting(const Signatures *signatures);
/* Has the coarse signatures of a model made for all aspects (coarse_bins) in the background, when nothing that was
 * asked for waits; once for each model and damage. Called again and again, it takes in what was made. Without
 * `background` or of fine ones: nothing. */
Status signatures_prepare(Signatures *signatures, int model, int damage);

/* Seed of a model's unevenness: a function of its name. */
uint64_t signature_warp_seed(const Model *model);

#endif
