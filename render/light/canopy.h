/* render/light/canopy.h: the diffuse light at a place among plants, in closed form: what is left of sky and ground, and
 * what leaves and branches scatter.
 *
 * Sky and ground. What plants hide of slanted light follows from the shadows of their prototypes (PlantShade), counted
 * on a grid of cells, for plants that stand apart; and, for the sky, in the cells that light crosses on its way
 * (canopy_shade.c; sources, equations and errors: etc/reference/terrain.md). Where no shadows are known: level layers
 * of leaves of every direction (G = 1/2), of whose index L above a place 2 E3(L / 2) of an even sky are let through
 * (Monsi & Saeki 1953; Ross 1981). A hit on a plant has that of other plants, and of what its own leaves it
 * (PlantQuad.open_up, open_down).
 *
 * Leaves. From where neither is seen come leaves and branches, all of one exitance M. A surface of theirs returns w / 2
 * of what falls on both its sides: of direct sun, 1/2 E_sun of the share that reaches it; of sky and ground, the shares
 * u and d that a leaf of the stand sees on average; and of M itself, 2 - u - d. So M = w/2 (E_leaf + u E_sky + d
 * E_ground) / (1 - w/2 (2 - u - d)), all scattering orders at once (recollision: Knyazikhin et al. 1998; Smolander &
 * Stenberg 2005), and E_ground what the ground returns of the sun and sky that leaves let through, and of M from where
 * they do not. w: reflectance and transmittance of leaves, reflectance of bark, by the areas of both, as far as light
 * reaches them. Even light on surfaces that absorb nothing stays even light.
 *
 * Error, beside a path tracer of all orders: tests/system/test_plants_judge.sh, test_plants_within_deep.sh. Thermal
 * bands are without it: leaves radiate as much as they hide. Low plants, and the side of the scattered light, are left
 * out. */
#ifndef RENDER_LIGHT_CANOPY_H
#define RENDER_LIGHT_CANOPY_H

#include "render/air/air.h"
#include "render/materials/materials.h"
#include "render/trace/plants/forest.h"
#include "render/trace/plants/plants_kept.h"
#include "render/scene/hits.h"
#include "terrain/woods/woods.h"

typedef struct Canopy Canopy;

/* 4 octets a cell of 64 m2. leaves: false: deciduous plants are bare, and let all through. materials and plants: with
 * their rows of plants, and their openness; not kept. */
Status canopy_create(Canopy **out, const Woods *woods, const Plants *plants, const Materials *materials, bool leaves);
void   canopy_destroy(Canopy *canopy);
/* From here on the plants of the forest's pages are part of the canopy where light is asked for (canopy_light): cells
 * of a page, 64 kB, are made when a hit on one of its plants or nearer than far_m needs them, and kept. Of crowns that
 * reach over a page's edge the part beyond is left out. canopy_stand knows none of them. forest must outlive it. */
Status canopy_see_pages(Canopy *canopy, const Forest *forest, bool leaves);
/* The same from the cache, or into it. */
Status canopy_create_kept(Canopy **out, const Woods *woods, const Plants *plants, const Materials *materials,
                          bool leaves, const PlantsKept *kept);
/* A canopy of woods of this size and place without plants, for canopy_kept_values, KeptValues of it. */
Status     canopy_create_bare(Canopy **out, const Woods *woods);
KeptValues canopy_kept_values;
/* Adds the optics of plants, and where their rows are, to a key. */
void canopy_key_add_plants(CacheKey *key, const Materials *materials);

/* Leaf area index above a place, height_m above its ground. */
double canopy_leaf_area_above(const Canopy *canopy, double x_m, double y_m, double height_m);
/* Plants of the cell there: leaf area, where it is, the share of an even sky that reaches the ground, and the area of
 * leaves at random (G = 1/2) that hides as much from overhead. */
typedef struct CanopyStand {
    double leaf_area, base_m, top_m, open, hides;
} CanopyStand;
void canopy_stand(CanopyStand *out, const Canopy *canopy, double x_m, double y_m);
/* Light of this sine of elevation sees clumped * hides of that area: exp(-clumped hides / (2 sine)) of it reaches the
 * ground. */
double canopy_clumping(const Canopy *canopy, double up);
/* 2 E3(x), x >= 0: within 1e-4. */
double canopy_gap(double x);

/* A place among plants: what layers above and below it let through, of the sky and the ground, and of the sun on level
 * ground. Sun of this sine of elevation. False: no plants there, all 1. */
typedef struct CanopyPlace {
    double up, down, up_from_ground;
    double sun_here, sun_on_ground;
    double seen_up, seen_sun;            /* up and sun_here of the leaves that are seen from there upwards */
    double past_up, past_down, past_sun; /* up, down and sun_here past other plants than the one that stands there */
    double past_low_up, past_low_down;   /* those of the light on walls */
    double low, towards[2]; /* share of the sky's light on walls all around; and how much more of it comes from east and
                             * north than from west and south, over the light of an open sky on level ground */
} CanopyPlace;
bool canopy_place(CanopyPlace *out, const Canopy *canopy, double x_m, double y_m, double height_m, double sin_sun);
/* The same for the ground or another surface there, which sees the leaves above it. */
void canopy_place_of_ground(CanopyPlace *place, const Canopy *canopy);
/* Shares of sky and ground that a leaf or branch there sees, to which its own plant leaves these. */
void canopy_place_past_plant(double *up, double *down, const CanopyPlace *place, const Canopy *canopy, double open_up,
                             double open_down);
/* The same for a leaf or branch there, to which its own plant leaves the mean of all. */
void canopy_place_of_plant(CanopyPlace *place, const Canopy *canopy);
/* M there in an optical channel, W/m2, and what falls on its ground, W/m2. sun, facing it, and sky: W/m2. */
double canopy_exitance(double *on_ground_w_m2, const Canopy *canopy, const CanopyPlace *place, int channel,
                       double sun_w_m2, double sky_w_m2, double sin_sun, double ground_rho);

/* Light at hits, of optical channels: a surface of normal n receives
 *     up E_sky(n) + down ground E_ground(n) + (1 - up (1 + n_z) / 2 - down (1 - n_z) / 2) leaves_w_m2,
 * E_sky and E_ground as in the open; of leaves, each of both sides. */
typedef struct CanopyLight {
    float up[hits_capacity], down[hits_capacity];            /* shares of sky and ground that are seen */
    float ground[optical_channel_count][hits_capacity];      /* the ground's brightness over that of open ground */
    float leaves_w_m2[optical_channel_count][hits_capacity]; /* M */
} CanopyLight;

/* channels: 1 << optical_channel, others are ignored. False: no plants near any of the hits; *out has no
 * meaning then. */
bool canopy_light(CanopyLight *out, const Canopy *canopy, const Landscape *landscape, const Daylight *light,
                  const float ground_rho[optical_channel_count], const Hits *hits, unsigned channels);

#endif
