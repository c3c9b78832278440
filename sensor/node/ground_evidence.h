/* sensor/node/ground_evidence.h: what an exercise says of its ground and its sea.
 *
 * On the ground: land platforms, life forms, cultural features, supplies and sensors on land, mines, landed aircraft
 * and bursts that say ground impact. Not: what is carried or falls, and what is aboard a ship. An aircraft has landed
 * that stands still to 5 mm for 5 s and is a fixed-wing one, or has its engine off where its sender is known to say so,
 * or stands as high as the entities around it: a helicopter that only hangs in the air is none. The sea: wherever
 * surface and subsurface platforms were. Its level is the median of the ships' own, one ship one vote; of submarines
 * alone 0 or the highest of them. What stands on land is on land even amid ships, unless it is within a ship's hull or
 * on its deck: an amphibious vehicle among ships makes its own small island. */
#ifndef SENSOR_NODE_GROUND_EVIDENCE_H
#define SENSOR_NODE_GROUND_EVIDENCE_H

#include "entities/catalog/catalog.h"
#include "entities/survey/survey.h"
#include "terrain/landscape/landscape.h"

typedef enum Stance {
    STANCE_OTHER,      /* in the air, or nothing is known */
    STANCE_FLIES,      /* its way is clear of the ground */
    STANCE_GROUND,
    STANCE_LANDED,     /* an aircraft, for some of its reports at least */
    STANCE_AFLOAT,
    STANCE_SUBMERGED,  /* a submarine that is never at the surface */
    STANCE_ABOARD,     /* a ship */
} Stance;

typedef struct GroundEvidence {
    LandscapeEvidence said;      /* its arrays are those below */
    GroundFix        *fix;
    ClearLine        *line;
    CoastPlace       *place;
    Stance           *stance;    /* [track_count] */
    double           *below_m;   /* [track_count] base below the reported place */
    bool             *fixed;     /* [points of all tracks] this report is on the ground; see first */
    size_t           *first;     /* [track_count] of its reports in fixed */
    int               count[STANCE_ABOARD + 1]; /* tracks of each stance */
    int               impacts;
} GroundEvidence;

/* p_aim: what the host's own munition was found to have hit, for a Detonation that names nothing; 0:0:0: nothing. */
Status ground_evidence_collect(GroundEvidence *out, const Survey *survey, const LocalFrame *frame,
                              const Catalog *catalog, DisEntityId host, DisEntityId aim);
void   ground_evidence_free(GroundEvidence *evidence);
/* A report's base. */
void   ground_evidence_base(double base_ecef[3], const TrackPoint *point, double below_m);

#endif
