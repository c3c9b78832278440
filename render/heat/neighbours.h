/* render/heat/neighbours.h: which other entities matter to the heat of one: those that fill its view, stand before
 * its sun, or blow their exhaust on it.
 *
 * Bodies are spheres about their origins that hold every pose. The share of a view that a body fills is at most
 * (radius / distance)^2, the view factor of a sphere before a plate that faces it; distance is from the nearest
 * place of the entity's own sphere, and at least the radius. Largest shares first, ties by id. */
#ifndef RENDER_HEAT_NEIGHBOURS_H
#define RENDER_HEAT_NEIGHBOURS_H

#include "dis/pdu/pdu.h"
#include "pitviper.h"

enum { near_seen_most = 8, near_sun_most = 8, near_jet_most = 4, near_most = near_seen_most + near_sun_most + near_jet_most };

typedef enum NearWhy { NEAR_SEEN = 1, NEAR_SUN = 2, NEAR_JET = 4 } NearWhy;

typedef struct NearBody {
    DisEntityId id;
    double      p_enu[3], v_enu_mps[3];
    double      radius_m;          /* 0: it counts as no neighbour */
    double      jet_m;             /* how far its exhaust may reach; 0: it has none */
} NearBody;

typedef struct Neighbour {
    int      body;
    unsigned why;                  /* NearWhy */
    double   share, fill;          /* at most, of a view; (radius / distance of origins)^2 */
} Neighbour;

typedef struct Neighbours {
    int       count, left_out;     /* left_out: beyond the numbers above */
    Neighbour of[near_most];       /* largest shares first */
} Neighbours;

/* body[count], by id. sun_d_enu: towards the sun; below the horizon it has none. resting: of those alone that do not
 * move against it, by 1 m/s. */
void neighbours_find(Neighbours *out, const NearBody *body, int count, int me, const double sun_d_enu[3], bool resting);

#endif
