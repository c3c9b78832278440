/* sensor/score/judge_private.h: parts of judging a frame and band, after its answers were matched whatever the class.
 */
#ifndef SENSOR_SCORE_JUDGE_PRIVATE_H
#define SENSOR_SCORE_JUDGE_PRIVATE_H

#include "sensor/score/judge.h"

enum { tracks_pairs_a_frame = 4096 };

/* counting: the first answers of the list, whose score counts. Of a frame the first 1024 targets and answers, and 4096
 * pairs. STATUS_NO_MEMORY; STATUS_BAD_VALUE, logged: an entity is there twice, or time does not advance. */
Status judge_tracks(Judge *judge, const TruthFrame *frame, Band band, int counting);
Status judge_end_tracks(Judge *judge);
void   judge_worst(Judge *judge, const TruthFrame *frame, Band band, int counting);

#endif
