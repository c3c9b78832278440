/* render/scene/skip.c: the names of the skips. */
#include "render/scene/skip.h"

static const struct {
    const char *name, *what;
} rows[SKIP_COUNT] = {
    [SKIP_BLOCK]         = {"block", "entities outside a block of pixels: block-entity pairs"},
    [SKIP_SPHERE]        = {"sphere", "entities missed or hidden, by their sphere: ray-entity pairs"},
    [SKIP_PART]          = {"part", "parts missed, by box and sphere: ray-part pairs"},
    [SKIP_GROUND_BEHIND] = {"ground_behind", "ground behind the part that was met: rays"},
    [SKIP_GROUND_BELOW]  = {"ground_below", "ground below a block of rays that all met parts: rays"},
    [SKIP_GROUND_WALK]   = {"ground_walk", "ground walked together with neighbours: rays"},
    [SKIP_SUN_SPHERE]    = {"sun_sphere", "entities that sun rays miss: ray-entity pairs"},
    [SKIP_SUN_STOPPED]   = {"sun_stopped", "ground and plants behind what stops the sun: rays"},
    [SKIP_SUN_CLEAR]     = {"sun_clear", "ground too low to stop the sun: rays"},
    [SKIP_AMODAL]        = {"amodal", "entities with nothing behind what was met: ray-entity pairs"},
    [SKIP_CELL]          = {"cell", "samples beside a small target: rays"},
    [SKIP_RETRACE]       = {"retrace", "first rays of refined pixels, known from their planes: rays"},
    [SKIP_SMOKE]         = {"smoke", "smoke and dust outside a block of pixels: block-volume pairs"},
    [SKIP_LIGHT]         = {"light", "light of places near vehicles, asked for once a frame: hits that may share it"},
    [SKIP_TREE]          = {"tree", "entities left out by the tree of their spheres: block-entity, ray-entity pairs"},
    [SKIP_KEPT]          = {"kept", "what paths from sample points meet, kept from earlier frames: points"},
};

const char *skip_name(Skip skip) { return rows[skip].name; }
const char *skip_what(Skip skip) { return rows[skip].what; }
