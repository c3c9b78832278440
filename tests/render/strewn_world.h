/* tests/render/strewn_world.h: hand-made things strewn over hand-made ground, in real light. */
#ifndef TESTS_RENDER_STREWN_WORLD_H
#define TESTS_RENDER_STREWN_WORLD_H

#include "tests/render/hand_world.h"

static const double sun_enu[3] = {-0.48, 0.36, 0.8};

static inline int open_world(void **state)
{
    (void)state;
    return hand_open(true);
}

static inline double ground_at(double x, double y) { return elevation_height(&hand.landscape.elevation, x, y, NULL); }

/* Real light, and the hand-made things strewn over the ground from 60 m to 3 km before the eye. */
static inline View strew(int things, int width, int height)
{
    const double eye_enu[3] = {-400, 0, ground_at(-400, 0) + 40}, ahead[3] = {1, 0, -0.09};
    hand_air_on(sun_enu, 40);
    hand_clear();
    hand_draw = 77;
    for (int k = 0; k < things; k++) {
        const double ahead_m = 60 * pow(50, (k + 0.5) / things), aside_m = hand_uniform(-0.2, 0.2) * ahead_m;
        double       p_enu[3] = {eye_enu[0] + ahead_m, eye_enu[1] + aside_m, 0}, r[9];
        p_enu[2] = ground_at(p_enu[0], p_enu[1]) + (k % hand_models == hand_sphere_model ? 0.9 : 0);
        hand_attitude(r, hand_uniform(0, 6), 0);
        hand_add(k % hand_models, p_enu, r);
    }
    return hand_view(eye_enu, ahead, width, height, width * 2.2);
}

static inline RenderRequest request_of(const View *view)
{
    RenderRequest request = hand_request(view);
    request.bands = 15;
    request.profile_bins = 600;
    request.profile_bin_m = 1;
    return request;
}

#endif
