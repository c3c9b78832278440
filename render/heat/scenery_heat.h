/* render/heat/scenery_heat.h: temperatures of scenery (entities/scenery): buildings and works by what they are built
 * of, clutter by what it does.
 *
 * Buildings and works. What a part is built of is a row of etc/constructions.csv (construction.h). Each that some part
 * has is conduction in layers (wall_column_private.h) under the weather, for normals over the upper hemisphere, in the
 * sun and in the shade, on the grid of time of the ground's heat (heat.h), of which it is no part: with the same
 * spin-up and kept in the same cache, and ground is the same with it or without. What faces down
 * has the sky and ground of a wall of that side, and the sun of its own normal. Between facets the error is 0.5 K at
 * most of walls and 1.3 K of slopes along which the sun grazes, 0.2 K rms. About a wall the ground is half grass and
 * half paved.
 *
 * Clutter. Each SceneryState is one entity of its model (vehicle_heat.h) that stands alone in open level grass at the
 * world's origin, has done the same for an hour, and stood cold before; with stood_s, its engine stopped so long before
 * the exercise begins. It advances by clutter_step_s of exercise time, whatever frames are rendered. All objects of
 * the state are as warm as its patches: the sun and wind of another heading than theirs are the error of that.
 *
 * Shade. A wall that faces away from the sun has none of it. With a ShadowMap, relief and plants shade an object of
 * buildings as they do the ground where the place is, or a cell of the map before a wall: the share of the past direct
 * sun that was taken, by the construction's own memory of it. So a wall is in the shade as its foot is, and what the
 * map does not know (eaves, a wing of the same house, a neighbour within a cell) leaves it too warm by up to what shade
 * and sun differ by: 11 K of brick and of sheet at 14 h in June (tests/render/test_scenery_heat.c). Its sky is open.
 * Clutter stands in the open.
 *
 * Temperatures are at the height of the weather's thermometer over the origin, as the ground's are. */
#ifndef RENDER_HEAT_SCENERY_HEAT_H
#define RENDER_HEAT_SCENERY_HEAT_H

#include "entities/scenery/scenery.h"
#include "render/heat/construction.h"
#include "render/heat/heat.h"
#include "render/heat/part_table.h"

enum { scenery_most_walls = 192, scenery_most_states = 256, scenery_most_facets = 33 };
static const double clutter_step_s = 60;

typedef struct SceneryHeat  SceneryHeat;
typedef struct SceneryTemps SceneryTemps;

/* Where the wind blows to at a time, at the height of low things, m/s. */
typedef void SceneryWind(double wind_enu_mps[3], double unix_s, const void *user);

/* All that is pointed to outlives the heat, but for ground and constructions, which are copied. */
typedef struct SceneryHeatConfig {
    HeatConfig           heat;     /* as the ground's; facets: of walls; weather, user, pool, cache */
    double               east_rad; /* longitude of the place: rooms are heated by its sun's mean time */
    SceneryWind         *wind;     /* NULL: none; user: that of heat */
    const GroundKinds   *ground;
    const Constructions *constructions;
    const Materials     *materials;
    const PartTable     *parts;
    const LocalFrame    *frame;
    const ShadowMap     *shadow; /* NULL: nothing shades it */
    const char          *isa;    /* of Embree, for the views of clutter's patches */
} SceneryHeatConfig;
SceneryHeatConfig scenery_heat_default_config(void); /* the numbers */

/* Spins up, at exercise time 0. scenery must outlive it. STATUS_NO_MEMORY, STATUS_BAD_VALUE (logged). */
Status scenery_heat_create(SceneryHeat **out, const SceneryHeatConfig *config, const Scenery *scenery);
void   scenery_heat_destroy(SceneryHeat *heat); /* accepts NULL */
/* In the arena; one thread at a time. Advances the state, some of the next step each time; times before the exercise:
 * as at its beginning. A frame before the last one starts again from there. */
Status scenery_temps_at(SceneryTemps **out, SceneryHeat *heat, double unix_s, Arena *arena);
size_t scenery_heat_bytes(const SceneryHeat *heat);

/* Without scenery: one construction (of config->constructions) of one material, of all normals. What probes ask. */
Status scenery_heat_wall(SceneryHeat **out, const SceneryHeatConfig *config, int construction, int material);
/* It, and what it takes and gives, for a normal of the upper hemisphere. taken: share of the direct sun, all day. */
typedef struct WallSeen {
    double temp_k, behind_k, air_k, ground_k, absorbed_w_m2, direct_w_m2, diffuse_w_m2, longwave_w_m2, film_w_m2k;
} WallSeen;
void scenery_wall_seen(WallSeen *out, const SceneryTemps *temps, const double n_enu[3], double taken);

/* Temperature of a place of an object's surface, K. part: of its model; p_body: in the model's axes; n_enu: unit,
 * outward. Any number of threads. */
double scenery_temp_k(const SceneryTemps *temps, int object, int part, const double p_body[3], const double n_enu[3]);

/* Where that comes from. Of buildings: temp_k = sun_k + taken (shade_k - sun_k). */
enum { scenery_most_sources = 4 };
typedef struct SceneryHeatOf {
    const Construction *of;                       /* its construction; NULL: clutter, or not known */
    double              sun_k, shade_k, behind_k; /* with all of the past sun, without; of what is behind it */
    double              taken;                    /* share of the past sun that relief and plants took */
    const SceneryState *state;                    /* of clutter: what it does; NULL: a building */
    int                 patches;                  /* those that it comes from, the most important first */
    struct {
        int      index;
        HeatRole role;
        double   share, temp_k;
    } patch[scenery_most_sources];
} SceneryHeatOf;
/* For records of single rays: slow. One thread at a time. */
void scenery_heat_of(SceneryHeatOf *out, const SceneryTemps *temps, int object, int part, const double p_body[3],
                     const double n_enu[3]);

#endif
