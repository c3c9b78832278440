/* terrain/landscape/ways.h: roads, lanes, tracks and streams of the synthetic landscape, and the plots of its villages:
 * a pure function of the seed, the terrain and the fixes. Streams follow the descent of the ground and end in
 * a pond, another stream, the sea or the rim of the finest level; roads join the villages and the rim. Nothing of it is
 * laid over a place where a vehicle was reported, except a track along the route of a vehicle. Heights are not changed.
 * Landscapes from files have none: their roads are in their cover, as classes without direction. */
#ifndef TERRAIN_LANDSCAPE_WAYS_H
#define TERRAIN_LANDSCAPE_WAYS_H

#include "terrain/landscape/ground_detail.h"
#include "terrain/landscape/landscape.h"

typedef enum WayKind { WAY_NONE, WAY_ROAD, WAY_LANE, WAY_TRACK, WAY_STREAM, WAY_GULLY, WAY_KINDS } WayKind;

/* The nearest way about a place. */
typedef struct WayPlace {
    WayKind kind;
    int     way;          /* its number */
    double  across_m;     /* signed distance of its middle, positive on the left */
    double  along_m;      /* from its start */
    double  half_m;       /* half its width there */
    double  direction[2]; /* unit vector along it, east and north */
} WayPlace;

/* false: none within some metres of its edge. */
bool landscape_way(WayPlace *out, const Landscape *landscape, double x_m, double y_m);

/* Vertices of a way in order, `most` of them at most; returns their number. 0: no such way. Numbered from 0. */
int landscape_way_vertices(double (*out)[2], WayKind *kind, const Landscape *landscape, int way, int most);

/* Wheel paths and worn edges of roads, ruts and the grassy middle of tracks, rows of crops and furrows: multiplied into
 * the factors and added to the rest of what detail holds. Filtered to the footprint (its longer axis); nothing of it is
 * left where that is half as wide as a way, or as rows are apart. */
void ways_detail(const GroundDetail *detail, const Landscape *landscape, int count, const uint8_t *surface,
                 const double *x_m, const double *y_m, const float *footprint_m);

/* Moves a place of a field with rows (crops, furrows) onto the middle of its row; false: the class has none. */
bool landscape_row(double place_m[2], const Landscape *landscape, SurfaceClass surface, double x_m, double y_m);

/* A village's plot: a rectangle beside its lane, with a place for a house. */
typedef struct HousePlot {
    double x_m, y_m;           /* middle of the plot */
    double direction[2];       /* unit vector along the lane */
    double half_along_m, half_across_m;
    double house[2];           /* middle of the house from the middle of the plot: along, and towards the lane */
    double house_half[2];      /* half the house's sides: along, and across */
} HousePlot;

/* All plots, owned by the landscape; NULL and 0 where there are none. */
const HousePlot *landscape_plots(const Landscape *landscape, int *count);
/* Village `index`'s centre; false: no such village. */
bool landscape_village(double place_m[2], const Landscape *landscape, int index);

/* How wet the ground is (hollows) or, below 0, worn (crests): -1 .. 1; 0 where there are no ways. */
double landscape_wetness(const Landscape *landscape, double x_m, double y_m);
/* Whether a way, a pond, a plot or a vehicle's place reaches into the cell of the index about a place. */
bool landscape_ways_near(const Landscape *landscape, double x_m, double y_m);

#endif
