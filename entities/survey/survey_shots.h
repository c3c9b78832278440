/* entities/survey/survey_shots.h: which Detonation ended which Fire. Private to the survey. */
#ifndef ENTITIES_SURVEY_SURVEY_SHOTS_H
#define ENTITIES_SURVEY_SURVEY_SHOTS_H

#include "entities/survey/shot.h"

/* One Fire or Detonation as received. */
typedef struct WarfareEvent {
    double      t_s;
    DisEntityId firing, target, munition;
    DisEventId  event;
    double      p_ecef[3]; /* Detonation */
    uint8_t     result;
    bool        is_detonation;
} WarfareEvent;

/* A Detonation belongs to the latest Fire before it of the same munition id that has none yet (ids are used again; the
 * event id decides where it can), else to that of the same event id. One received twice within half a second is one.
 * event is put in order of time. *shots is malloc'ed, in order of fire (else detonation) time. */
Status survey_join_shots(Shot **shots, int *shot_count, WarfareEvent *event, int count);
/* The numbers of the shots sorted by munition, then by number; malloc'ed. */
Status survey_order_shots(int **by_munition, const Shot *shot, int count);

#endif
