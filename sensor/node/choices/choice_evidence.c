/* sensor/node/choices/choice_evidence.c: the evidence of an exercise's ground, for those who choose, and its hash. */
#include "sensor/node/choices/ground_evidence_private.h"

#include <stdlib.h>

Status choice_evidence(GroundEvidence **out, const Survey *survey, const Catalog *catalog, const LocalFrame *frame)
{
    GroundEvidence *e = calloc(1, sizeof *e);
    if (!e) return STATUS_NO_MEMORY;
    const Status status = ground_evidence_collect(e, survey, frame, catalog);
    if (status == STATUS_OK) *out = e;
    else choice_evidence_free(e);
    return status;
}

void choice_evidence_free(GroundEvidence *evidence)
{
    if (!evidence) return;
    ground_evidence_free(evidence);
    free(evidence);
}

/* Member by member: what lies between members is anything. */
bool choice_evidence_hash(Sha256 *digest, const GroundEvidence *e)
{
    const int counts[] = {e->tracks, e->said.fix_count, e->said.line_count, e->said.place_count, e->impacts};
    bool      good = sha256_add(digest, counts, sizeof counts) &&
                sha256_add(digest, &e->said.sea_h_m, sizeof e->said.sea_h_m) &&
                sha256_add(digest, e->count, sizeof e->count) &&
                sha256_add(digest, e->stance, (size_t)e->tracks * sizeof *e->stance) &&
                sha256_add(digest, e->below_m, (size_t)e->tracks * sizeof *e->below_m) &&
                sha256_add(digest, e->first, (size_t)e->tracks * sizeof *e->first) &&
                sha256_add(digest, e->fixed, e->points * sizeof *e->fixed);
    for (int i = 0; i < e->said.fix_count && good; i++)
        good = sha256_add(digest, e->fix[i].p_enu, sizeof e->fix[i].p_enu) &&
               sha256_add(digest, &e->fix[i].voter, sizeof e->fix[i].voter);
    for (int i = 0; i < e->said.line_count && good; i++)
        good = sha256_add(digest, e->line[i].a_enu, sizeof e->line[i].a_enu) &&
               sha256_add(digest, e->line[i].b_enu, sizeof e->line[i].b_enu);
    for (int i = 0; i < e->said.place_count && good; i++) {
        const double place[3] = {e->place[i].x_m, e->place[i].y_m, e->place[i].sea};
        good = sha256_add(digest, place, sizeof place);
    }
    return good;
}
