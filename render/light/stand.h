/* render/light/stand.h: a stand of one class of forest, as it is seen from above: the shares of leaves, bark and ground, how
 * they face, what of sky and sun reaches them. Numbers of its shape alone, for every height of eye and sun.
 *
 * Traced once: rays from stand_views depressions, stand_rays each, through 26 ha of the plants of etc/woods.csv, everywhere as
 * dense, of which a view's hits are asked for the sun at stand_suns heights and stand_azimuths angles from behind the eye: so the clumping of
 * leaves in crowns and of crowns in patches, and that what the eye sees from the sun's side is lit (the hot spot, as wide as
 * the steps of the table), are those of the plants themselves. Statistical error of a share at a node: 0.025. */
#ifndef RENDER_LIGHT_STAND_H
#define RENDER_LIGHT_STAND_H

#include "render/forest/forest.h"
#include "render/light/canopy.h"

enum { stand_views = 6, stand_suns = 6, stand_azimuths = 5, stand_rays = 512 };

/* Of what one organ shows a view: sums over its hits, by the number of all rays. */
typedef struct StandOrgan {
    double share;                     /* of the view's rays */
    double bright;                    /* weighted by albedo, as what follows */
    double front_up, front_down;      /* shares of sky and ground on the side that is seen, times what that faces of them */
    double back_up, back_down;        /* on the other one */
    double n[2];                      /* normal: towards the eye's azimuth, up; not weighted */
    double open, radius_m;            /* not weighted; of radii the geometric mean */
} StandOrgan;

typedef struct StandView {
    StandOrgan  leaf, bark;
    double      ground, ground_up, ground_open;             /* share; of that the sky's that reaches it; by the heat's map */
    double      ground_through[stand_suns];                 /* of the sun, by the heat's map */
    double      sees_leaves;                                /* sum over plants: of other leaves; for the means of */
    CanopyPlace among[stand_suns], on_ground[stand_suns];   /* places over plants, by what they see of leaves; over the ground */
} StandView;

/* Of the sun: shares that it reaches, and those times the cosine to it, by the number of all rays. */
typedef struct StandLit {
    double leaf, leaf_front, leaf_back, bark_front, ground;
} StandLit;

typedef struct WoodStand {
    Canopy   *canopy;
    Material  leaf, bark;      /* means of what is seen */
    int       bark_row;        /* the most frequent */
    double    top_m;           /* height of the crowns that are seen, about */
    StandView view[stand_views];
    StandLit  lit[stand_views][stand_suns][stand_azimuths];
} WoodStand;

/* surface: a class of forest; density: over its mean. forest: whose prototypes stand in it; leaves: as that has. pool: may be
 * NULL; the same bits either way. */
Status stand_create(WoodStand **out, SurfaceClass surface, double density, const Forest *forest, const Materials *materials,
                    bool leaves, Pool *pool);
void   stand_destroy(WoodStand *stand); /* accepts NULL */

/* Nodes: elevation of eye or sun over the ground, and azimuth of the sun from that of the eye, rad. */
double stand_view(int node);
double stand_sun(int node);
double stand_azimuth(int node);
/* Place among the nodes: the lower one, and the share of the upper. */
int    stand_at_view(double *share, double elevation_rad);
int    stand_at_sun(double *share, double elevation_rad);
int    stand_at_azimuth(double *share, double azimuth_rad);

#endif
