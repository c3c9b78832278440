/* tests/sensor/store_frames.h: some frames over a landscape, as hashes. */
#ifndef TESTS_SENSOR_STORE_FRAMES_H
#define TESTS_SENSOR_STORE_FRAMES_H

#include "tests/check.h"

#include "sensor/quality/trial_private.h"

enum { frames = 3 };

typedef struct FrameHashes {
    char sha256[frames][sha256_text_size];
} FrameHashes;

/* A tank near, at some hundred metres, and from high above, in all bands. False: a frame failed. */
static inline bool render_all(FrameHashes *out, const Landscape *landscape)
{
    static const double view[frames][3] = {{60, 12, 20}, {400, 90, 12}, {700, 500, 40}}; /* back, above, degrees wide */
    static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};
    char                       catalog[512];
    Pool                      *pool = NULL;
    Arena                     *arena = arena_create();
    TrialScene                 scene;
    if (!arena || !etc_path(catalog, sizeof catalog, "catalog.csv") || pool_create(&pool, 2) != STATUS_OK) return false;
    bool good = trial_scene_open(&scene, landscape, catalog, &tank, 1, 1) == STATUS_OK;
    for (int n = 0; n < frames && good; n++) {
        const RenderRequest request = {.view =
                                           trial_view(&scene, view[n][0], view[n][1], view[n][2] * rad_per_deg, 48, 36),
                                       .bands = 7,
                                       .truth = true,
                                       .optical = OPTICAL_RGB,
                                       .samples = 1,
                                       .edge_samples = 4,
                                       .hidden_entity = -1,
                                       .sky_visibility = true};
        TrialFrame          frame = {.scene = &scene, .request = request, .pool = pool, .arena = arena};
        trial_frame(&frame);
        good = frame.status == STATUS_OK && trial_frame_hash(out->sha256[n], &frame) == STATUS_OK;
    }
    trial_scene_close(&scene);
    arena_destroy(arena);
    pool_destroy(pool);
    return good;
}

#endif
