/* render/air/air_legs.h: a straight path over the round Earth in pieces that the tables of paths know. */
#ifndef RENDER_AIR_AIR_LEGS_H
#define RENDER_AIR_AIR_LEGS_H

#include "render/air/atmosphere.h"

/* Of a path what is in the tables' air. Above top_m there is none: a path that stays there has no leg. One that is more
 * than half a kilometre below its lower end somewhere between is cut at its lowest point, so that each leg only falls
 * or only rises; with less the tables' own allowance for the chord (mean_chord_error_m) errs less than their
 * interpolation over a leg. The first leg begins at the observer; a path within the air that needs no cut stays as it
 * came. */
typedef struct AirLegs {
    int     count;
    AirPath leg[2], whole;
    double  cut; /* of two legs: what they make counts by this share, what whole makes by the rest: 1 from 1.5 km on */
} AirLegs;
AirLegs air_legs(const AirPath *path, double top_m);

/* A leg in pieces of 80 km and less, six at most, the nearest first: over a long one height changes too little like a
 * straight line for one estimate of what its air lets through, sends and scatters. Returns their number; of a short
 * leg, or one that begins below a kilometre, whose first air hides the rest, it is the leg itself. */
enum { air_pieces_max = 6 };
int air_leg_pieces(AirPath piece[air_pieces_max], const AirPath *leg);
/* Share that what the pieces send and scatter has in the leg's radiance, so that it does not step where they begin:
 * 0 .. 1, at twice their length and that height. */
double air_pieces_share(const AirPath *leg);

/* Height of the lowest point of a ray that goes down, by the cosine of its zenith angle at a height, m; not below 0. */
double air_tangent_m(double height_m, double up);

/* Two legs that meet at a height in one band: optical depth of both from each one's. Where single lines absorb, what
 * the first leg left has little in them: the depth of both is less than the sum, as depth grows with a power of the
 * amount of air, by the height 0.4 to 1. */
double air_legs_depth(AirBand band, double tangent_m, double first, double second);
/* Share of the second leg's radiance that passes the first one, of whose own emission these are the depths. */
double air_legs_passed(AirBand band, double tangent_m, double first, double second);
/* The same of the sky's radiance at the lowest point, seen level: it comes from far up, where lines are narrow. */
double air_legs_sky_passed(AirBand band, double tangent_m, double first);

#endif
