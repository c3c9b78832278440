/* render/light/far_woods.h: ground of woods whose plants were left out, shown as their canopy. */
#ifndef RENDER_LIGHT_FAR_WOODS_H
#define RENDER_LIGHT_FAR_WOODS_H

#include "render/trace/plants/forest.h"
#include "render/light/canopy.h"
#include "render/air/air.h"

/* ---- a stand --------------------------------------------------------------------------------- */

/* A stand of one class of forest, as it is seen from above: the shares of leaves, bark and ground, how
 * they face, what of sky and sun reaches them. Numbers of its shape alone, for every height of eye and sun.
 *
 * Traced once: rays from stand_views depressions, stand_rays each, through 26 ha of the plants of etc/woods.csv,
 * everywhere as dense, of which a view's hits are asked for the sun at stand_suns heights and stand_azimuths angles
 * from behind the eye: so the clumping of leaves in crowns and of crowns in patches, and that what the eye sees from
 * the sun's side is lit (the hot spot, as wide as the steps of the table), are those of the plants themselves.
 * Statistical error of a share at a node: 0.025. */

enum { stand_views = 6, stand_suns = 6, stand_azimuths = 5, stand_rays = 512 };

/* Of what one organ shows a view: sums over its hits, by the number of all rays. */
typedef struct StandOrgan {
    double share;                /* of the view's rays */
    double bright;               /* weighted by albedo, as what follows */
    double front_up, front_down; /* shares of sky and ground on the side that is seen, times what that faces of them */
    double back_up, back_down;   /* on the other one */
    double n[2];                 /* normal: towards the eye's azimuth, up; not weighted */
    double open, radius_m;       /* not weighted; of radii the geometric mean */
} StandOrgan;

typedef struct StandView {
    StandOrgan  leaf, bark;
    double      ground, ground_up, ground_open; /* share; of that the sky's that reaches it; by the heat's map */
    double      ground_through[stand_suns];     /* of the sun, by the heat's map */
    double      sees_leaves;                    /* sum over plants: of other leaves; for the means of */
    CanopyPlace among[stand_suns],
        on_ground[stand_suns]; /* places over plants, by what they see of leaves; over the ground */
} StandView;

/* Of the sun: shares that it reaches, and those times the cosine to it, by the number of all rays. */
typedef struct StandLit {
    double leaf, leaf_front, leaf_back, bark_front, ground;
} StandLit;

typedef struct WoodStand {
    Canopy   *canopy;
    Material  leaf, bark; /* means of what is seen */
    int       bark_row;   /* the most frequent */
    double    top_m;      /* height of the crowns that are seen, about */
    StandView view[stand_views];
    StandLit  lit[stand_views][stand_suns][stand_azimuths];
} WoodStand;

/* surface: a class of forest; density: over its mean. forest: whose prototypes stand in it; leaves: as that has. pool:
 * may be NULL; the same bits either way. */
Status far_stand_create(WoodStand **out, SurfaceClass surface, double density, const Forest *forest,
                        const Materials *materials, bool leaves, Pool *pool);
void   far_stand_destroy(WoodStand *stand); /* accepts NULL */
/* An empty stand for far_stand_kept_values, KeptValues of it. rows: of materials. */
Status far_stand_create_bare(WoodStand **out);
typedef struct StandKept {
    WoodStand *stand;
    int        rows;
} StandKept;
KeptValues far_stand_kept_values;

/* Nodes: elevation of eye or sun over the ground, and azimuth of the sun from that of the eye, rad. */
double far_stand_azimuth(int node);
/* Place among the nodes: the lower one, and the share of the upper. */
int far_stand_at_view(double *share, double elevation_rad);
int far_stand_at_sun(double *share, double elevation_rad);
int far_stand_at_azimuth(double *share, double azimuth_rad);

/* ---- far woods ------------------------------------------------------------------------------- */

/* Ground of woods whose plants were left out has the reflectance, emissivity and temperature of their canopy, not its
 * height.
 *
 * Two stands of each class of forest, sparse and dense, are learnt once (WoodStand): what of leaves, bark and ground is
 * seen from a depression, and what of it the sun reaches. Once a frame the light of this sun and sky on them becomes a
 * table over the eye's angle to the ground and its azimuth from the sun, of level ground that has the same radiance: a
 * reflectance by channel, a share of direct sun for the channels of heat, a temperature. The light is that of plants
 * (render/light/surface_light.h, canopy.h) and the temperatures those of leaves, bark and shaded ground (thermal.h,
 * render/heat), each of the mean of its organ; the temperature of all is that of their radiance in 8-12 um, so 3-5 um
 * differ by what is hotter than its mean.
 *
 * Between the densities, open ground included, by the share of it that is open to the eye: exp(-2.5 density / sine of
 * its height). So glades and thickets are where the plants would have them; groves of one kind are not.
 *
 * Relief and hills shade them as any ground, from the crowns' height. Slopes change the angle of the eye alone.
 *
 * Errors beside the same woods planted (tests/render/test_far_woods.c: means over 1.2 km; eye at 15 to 60 degrees, sun
 * at 9 to 63): optical channels 8 % rms, within 12 % (near infrared 10 %, 19 %), with the sun behind the eye within 12
 * degrees 18 %; 0.7 K apparent in 3-5 um, 0.6 K in 8-12 um. Without leaves 14 % rms, within 23 %; 2.1 K, 1.6 K. */

enum { far_stands = 2 /* broadleaf, conifer */, far_densities = 2, far_grounds = 2 /* of its own class; scrub */ };

typedef struct FarWoods {
    const Woods *woods;
    WoodStand   *stand[far_stands][far_densities];
    int          row[far_stands]; /* of Materials: what the tables stand on, without gloss */
} FarWoods;

/* Adds its rows to the materials, behind those that are counted (Materials.more). woods: of the world, kept. *out NULL:
 * woods without a place outside (made by hand). kept: where its stands are kept. pool: may be NULL. */
Status far_woods_create(FarWoods **out, const Woods *woods, const Forest *forest, Materials *materials, bool leaves,
                        const PlantsKept *kept, Pool *pool);
void   far_woods_destroy(FarWoods *far); /* accepts NULL */

/* Of one direction of the eye: [0] where hills hide the sun, [1] where they do not. */
typedef struct FarNode {
    float reflects[2][optical_channel_count]; /* over the row's reflectance */
    float warmer_k[2];                        /* than the air */
    float sun;                                /* share of the direct sun, of channels of heat */
    float radar;                              /* gamma */
} FarNode;

typedef struct FarWoodsFrame {
    const FarWoods *far;
    double          sun_azimuth_rad;
    double          sun_w_m2[optical_channel_count], sky_w_m2[optical_channel_count]; /* on level ground */
    FarNode         node[far_stands][far_densities][far_grounds][stand_views][stand_azimuths];
} FarWoodsFrame;

/* In the arena; *out NULL where far is. air: with its heat. */
Status far_woods_frame(FarWoodsFrame **out, const FarWoods *far, const Air *air, const Materials *materials,
                       Arena *arena);

/* Those of a block's hits that lie in far woods. */
typedef struct FarPlaces {
    uint8_t stand[hits_capacity];                         /* 0: not; else 1 + its index */
    float   cover[hits_capacity], density[hits_capacity]; /* woods_not_standing */
    float   planted[hits_capacity];                       /* share of the plants there that stand in pages */
} FarPlaces;
/* Returns whether any does. plants: the frame's, whose pages stand for the canopy (forest_far_share);
 * may be NULL. */
bool far_woods_find(FarPlaces *out, const FarWoods *far, const ForestFrame *plants, const Hits *hits);
/* How far above the ground the crowns are that the sun reaches. */
double far_woods_top_m(const FarWoods *far, int stand);

/* Inputs of light (render/light/surface_light.h) at the hits of a block, changed where they lie in far woods. */
typedef struct FarInputs {
    const FarPlaces *places;                         /* some of them are */
    const float     *sun;                            /* share that arrives */
    uint16_t        *material;                       /* row */
    float           *texture[optical_channel_count]; /* of the requested channels, else NULL */
    float           *far_sun;                        /* in: sun */
    float           *radar;                          /* of the ground's own gamma */
    float           *warmer_k, *of_far; /* out: than the air, and the share of the canopy in this; 0: none */
} FarInputs;
void far_woods_apply(const FarInputs *in, const FarWoodsFrame *frame, const Materials *materials, const Hits *hits,
                     const Rays *rays);

#endif
