/* render/light/lamps.h: what lamps of scenery (entities/scenery/scenery_lamps.h) add to the radiance of the optical
 * channels by night: their own, and that of ground, walls and plants that they light.
 *
 * A pane shines as a diffuse plane does, in one place at its middle; a street lamp as a diffuse plane that faces down;
 * two headlamps as one beam, cos^n of the angle off its axis, which is dipped by a hundredth, and of which a fiftieth
 * is left above the horizontal. Light falls off as 1 / (r^2 + area / pi), which is exact on the axis of a disc; it ends
 * at a reach, where 1 - (r / reach)^4, squared, makes it nothing: within 2 % of the whole up to 0.31 of the reach.
 *
 * Left out: shadows (a wall that faces a lamp is lit through what stands between: of lit ground in a village some
 * tenth), light that is reflected twice, gloss (lamps are in no mirror), the far side of leaves, thermal channels
 * (glass is opaque there), smoke and air that shine by them. */
#ifndef RENDER_LIGHT_LAMPS_H
#define RENDER_LIGHT_LAMPS_H

#include "entities/scenery/scenery_lamps.h"
#include "render/air/air.h"
#include "render/materials/materials.h"
#include "render/scene/hits.h"
#include "render/trace/scenery/scenery_tracer.h"

/* etc/lamps.csv, whose head explains the columns. */
typedef struct LampType {
    char            name[32];
    SceneryLampKind where;
    double          share, flux_lm, luminance_cd_m2, beam_rad;
    double          w_lm[optical_channel_count]; /* by the channel in each place */
} LampType;

enum { lamp_types_most = 64 };
typedef struct LampTypes {
    int      count;
    LampType type[lamp_types_most];
} LampTypes;

Status lamp_types_read(LampTypes *out, const char *path);
/* The type of a lamp; NULL: there is none of its kind. */
const LampType *lamp_type_of(const LampTypes *types, const SceneryLamp *lamp);

/* Farthest that a lamp lights, m; less where it would give below lamp_least_lx at right angles. */
static const double lamp_farthest_m[LAMP_KINDS] = {[LAMP_WINDOW] = 20, [LAMP_STREET] = 80, [LAMP_VEHICLE] = 120};
static const double lamp_least_lx = 0.02;

/* What is lit at one time. */
typedef struct LampLight LampLight;

/* NULL: nothing is: by day, and where there are no lamps. In the arena; O(lamps of the scenery). frame: poses what
 * drives; sun_d_enu, lat_rad: the hour follows. */
Status lamp_light_create(LampLight **out, const LampTypes *types, const SceneryFrame *frame, const double sun_d_enu[3],
                         double lat_rad, Arena *arena);
/* Lit lamps. */
int lamp_light_count(const LampLight *light);

/* Luminous flux per area, lx, that a plane of this unit normal gets at a place; and W/m2 of a channel. */
double lamp_light_lux(const LampLight *light, const double p_enu[3], const double n_enu[3]);
void   lamp_light_irradiance(double w_m2[optical_channel_count], const LampLight *light, const double p_enu[3],
                             const double n_enu[3]);

/* Radiance of hit i at the surface, W/(m2 sr), that lamps add; texture: of the channels of `channels` (1 << channel),
 * as SurfaceBlock. All zero of a ray that met nothing. */
void lamp_light_at(double w_m2_sr[optical_channel_count], const LampLight *light, const Materials *materials,
                   uint16_t material, const float *const texture[AIR_BAND_COUNT], unsigned channels, const Hits *hits,
                   const Rays *rays, int i);

#endif
