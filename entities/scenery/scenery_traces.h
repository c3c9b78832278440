/* entities/scenery/scenery_traces.h: what clutter that drives leaves behind it where its way is soil: dust, and on the
 * ground the lines of its wheels; and the lines of what came and stands.
 *
 * The same as of entities (entities/traces/vehicle_traces.h): dust as puffs of the row `dust` of etc/effects.csv, of a
 * small trail at 10 m/s and with the 1.5th power of its speed (a kilometre's is that of the square root of speed: US
 * EPA AP-42, 13.2.2, public unpaved roads, typed from knowledge; times how many a second); marks as GroundTrack, which
 * heat and loosen. Motion is a closed form of time, so is all of it: a pure function of scenery, time and eye. Nothing
 * lies ahead of what drives but what it left on its last round. Paved ways, rock and water have none of it. */
#ifndef ENTITIES_SCENERY_SCENERY_TRACES_H
#define ENTITIES_SCENERY_SCENERY_TRACES_H

#include "entities/scenery/scenery.h"
#include "terrain/earth/geodesy.h"

/* Of more the nearest to the eye, and none beyond the range: marks there are a tenth of a pixel wide. Dust only of what
 * is in view, or drives near by it. */
enum { scenery_dusts_most = 32, scenery_trails_most = 64, scenery_trail_pieces = 64, scenery_ruts_most = 8192 };
static const double scenery_dusts_m = 3000, scenery_tracks_m = 2000;

/* One stretch of a mover's way: it passed a_enu at a_s and b_enu at b_s. */
typedef struct SceneryStretch {
    double a_enu[3], b_enu[3], a_s, b_s;
    bool   loose;
} SceneryStretch;
/* Those that it drove in the last span_s up to t_s, but no longer ago than one round: the newest first, which ends
 * where it is at t_s. Returns how many, at most `most`. */
int scenery_driven(SceneryStretch *out, int most, const Scenery *scenery, const SceneryMover *mover, double t_s,
                   double span_s);

/* Puts the dust behind the snapshot's own puffs, as scenery_smoke does smoke. In the arena. */
Status scenery_dust(Snapshot *snapshot, const Scenery *scenery, const LocalFrame *frame, const SceneryCone *seen,
                    Arena *arena);

/* own with the marks of scenery behind its tracks; own itself where there are none. In the arena. */
Status scenery_marks(GroundMarks *out, const GroundMarks *own, const Scenery *scenery, const LocalFrame *frame,
                     const double eye_enu[3], double t_s, Arena *arena);

#endif
