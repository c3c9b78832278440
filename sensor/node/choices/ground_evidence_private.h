/* sensor/node/choices/ground_evidence_private.h: what the reports of an exercise imply about its ground and its sea.
 *
 * On the ground: land platforms, life forms, cultural features, supplies and sensors on land, mines, landed aircraft
 * and bursts with a result of ground impact. Not: carried or falling entities, and those aboard a ship. An aircraft
 * has landed if it is stationary to 5 mm for 5 s and is a fixed-wing one, or has its engine off and its sender is
 * known to report engines, or is as high as the entities around it: a hovering helicopter does not count. The sea:
 * wherever surface and subsurface platforms were. Its level is the median of the levels of the ships, one value per
 * ship; of submarines alone 0 or the highest of them. Entities on land are on land even amid ships, unless within a
 * ship's hull or on its deck: an amphibious vehicle among ships makes its own small island. */
#ifndef SENSOR_NODE_CHOICES_GROUND_EVIDENCE_PRIVATE_H
#define SENSOR_NODE_CHOICES_GROUND_EVIDENCE_PRIVATE_H

#include "entities/catalog/catalog.h"
#include "entities/survey/survey.h"
#include "sensor/node/choices/choices.h"
#include "terrain/ground/landscape.h"

typedef enum Stance {
    STANCE_OTHER, /* in the air, or nothing known */
    STANCE_FLIES, /* its path is clear of the ground */
    STANCE_GROUND,
    STANCE_LANDED, /* an aircraft, for at least some of its reports */
    STANCE_AFLOAT,
    STANCE_SUBMERGED, /* a submarine that never surfaces */
    STANCE_ABOARD,    /* a ship */
} Stance;

struct GroundEvidence {
    int               tracks;
    size_t            points; /* of all tracks */
    LandscapeEvidence said;   /* its arrays are those below */
    GroundFix        *fix;
    ClearLine        *line;
    CoastPlace       *place;
    Stance           *stance;                   /* [track_count] */
    double           *below_m;                  /* [track_count] depth of the base below the reported position */
    bool             *fixed;                    /* [points of all tracks] this report is on the ground; see first */
    size_t           *first;                    /* [track_count] of its reports in fixed */
    int               count[STANCE_ABOARD + 1]; /* tracks of each stance */
    int               impacts;
};

/* A hit that names no entity is of the target of its Fire, else of the entity nearest to the burst. */
Status ground_evidence_collect(GroundEvidence *out, const Survey *survey, const LocalFrame *frame,
                               const Catalog *catalog);
void   ground_evidence_free(GroundEvidence *evidence);
/* A report's base. */
void ground_evidence_base(double base_ecef[3], const TrackPoint *point, double below_m);

#endif
