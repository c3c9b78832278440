/* sensor/node/cigi/cigi_drawn.c: a CIGI host's entities into the entity table, frame by frame. */
#include "sensor/node/cigi/cigi_drawn.h"

#include "entities/motion/dead_reckoning.h"
#include "terrain/earth/geodesy.h"

enum { moves_straight = 2, moves_and_turns = 3 }; /* dead reckoning: FPW, RPW */

static CigiShown *shown_of(CigiDrawn *d, uint16_t id)
{
    for (int i = 0; i < d->count; i++)
        if (d->shown[i].id == id) return &d->shown[i];
    return NULL;
}

/* Whether it is to be drawn, and as what; counts those that cannot be. */
static const CigiType *type_of(CigiDrawn *d, const CigiScene *scene, const CigiEntityControl *e, uint16_t view)
{
    enum { least_reserved = 65534 };
    if (e->state != cigi_entity_active || e->type == 0 || cigi_scene_carries(scene, view, e->id)) return NULL;
    const CigiType *type = e->id > 0 && e->id < least_reserved ? cigi_types_find(&d->types, e->type) : NULL;
    uint8_t *const  told = &d->told[e->id / 8];
    const uint8_t   bit = (uint8_t)(1u << e->id % 8);
    if (!type && !(*told & bit)) {
        d->unmapped++;
        *told |= bit;
    }
    return type;
}

static void velocity_of(double v_ecef_mps[3], double w_ecef_rps[3], const CigiScene *scene, uint16_t id,
                        const double p_ecef[3], const CigiShown *before, double t_s)
{
    static const double longest_s = 1;
    memset(v_ecef_mps, 0, 3 * sizeof *v_ecef_mps);
    memset(w_ecef_rps, 0, 3 * sizeof *w_ecef_rps);
    if (cigi_scene_rates(v_ecef_mps, w_ecef_rps, scene, id) || !before) return;
    const double step_s = t_s - before->t_s;
    if (step_s == 0) memcpy(v_ecef_mps, before->v_ecef_mps, 3 * sizeof *v_ecef_mps);
    if (!(step_s > 0 && step_s <= longest_s)) return;
    for (int k = 0; k < 3; k++) v_ecef_mps[k] = (p_ecef[k] - before->p_ecef[k]) / step_s;
}

static Status report(const CigiDrawn *d, EntityTable *table, DisEntityState *state, double t_s)
{
    state->header = (DisHeader){.version = 7, .exercise = 1, .type = dis_pdu_entity_state};
    state->id.site = d->site;
    state->id.application = d->application;
    if (d->by_arrival) entity_table_arrival(table, t_s, false);
    const Status status = entity_table_entity_state(table, state, t_s);
    return status == STATUS_UNSUPPORTED ? STATUS_OK : status; /* a full table counts it */
}

static Status show(CigiDrawn *d, EntityTable *table, const CigiScene *scene, const CigiEntityControl *e,
                   const CigiType *type, double t_s)
{
    DisEntityState state = {.id.entity = e->id, .force = (uint8_t)type->force, .type = type->type};
    CigiShown     *known = shown_of(d, e->id);
    double         r[9], v_ecef_mps[3], w_ecef_rps[3], w_body_rps[3], psi_rad, theta_rad, phi_rad;
    if (!cigi_scene_entity(state.p_ecef, r, scene, e->id)) return STATUS_OK;
    velocity_of(v_ecef_mps, w_ecef_rps, scene, e->id, state.p_ecef, known, t_s);
    m3_tmul_v3(w_body_rps, r, w_ecef_rps);
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, r);
    state.psi_rad = (float)psi_rad, state.theta_rad = (float)theta_rad, state.phi_rad = (float)phi_rad;
    for (int k = 0; k < 3; k++) {
        state.velocity_mps[k] = (float)v_ecef_mps[k];
        state.angular_rate_rps[k] = (float)w_body_rps[k];
    }
    state.dead_reckoning = v3_length(w_body_rps) > 0 ? moves_and_turns : moves_straight;
    state.marking_set = 1; /* ASCII */
    snprintf(state.marking, sizeof state.marking, "CIGI %u", e->id);
    if (!known) {
        if (d->count == cigi_entities_most) return STATUS_OK; /* the scene has no more */
        known = &d->shown[d->count++];
    }
    *known = (CigiShown){.id = e->id, .stays = true, .t_s = t_s};
    memcpy(known->p_ecef, state.p_ecef, sizeof known->p_ecef);
    memcpy(known->v_ecef_mps, v_ecef_mps, sizeof known->v_ecef_mps);
    return report(d, table, &state, t_s);
}

Status cigi_drawn_show(CigiDrawn *drawn, EntityTable *table, const CigiScene *scene, uint16_t view, double t_s)
{
    Status status = STATUS_OK;
    for (int i = 0; i < drawn->count; i++) drawn->shown[i].stays = false;
    for (int i = 0; i < scene->entity_count && status == STATUS_OK; i++) {
        const CigiEntityControl *e = &scene->entity[i];
        const CigiType          *type = type_of(drawn, scene, e, view);
        if (type && (shown_of(drawn, e->id) || drawn->count < cigi_entities_most))
            status = show(drawn, table, scene, e, type, t_s);
    }
    for (int i = 0; i < drawn->count && status == STATUS_OK; i++) {
        if (drawn->shown[i].stays) continue;
        DisEntityState end = {.id.entity = drawn->shown[i].id, .appearance = 1u << dis_appearance_deactivated_bit};
        memcpy(end.p_ecef, drawn->shown[i].p_ecef, sizeof end.p_ecef);
        status = report(drawn, table, &end, t_s);
        drawn->shown[i--] = drawn->shown[--drawn->count];
    }
    return status;
}
