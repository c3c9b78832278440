/* sensor/node/flight/flight_report.c: the PDUs of a missile in the loop. */
#include "sensor/node/flight/flight_report.h"

#include <stdio.h>

enum { algorithm_fvw = 5, warfare = 2, information = 1, pdu_room = 2048 };

static DisHeader header(const FlightReport *r, uint8_t type, uint8_t family, double t_s)
{
    enum { constructive = 6 }; /* status of version 7: live-virtual-constructive, bits 1 and 2 */
    return (DisHeader){.version = r->of.version,
                       .exercise = r->of.exercise,
                       .type = type,
                       .family = family,
                       .timestamp = r->of.stamp(r->of.user, t_s),
                       .status = r->of.version == 7 ? constructive : 0};
}

static DisEventId event_of(const FlightReport *r, const FlightLoop *l)
{
    return (DisEventId){l->id.site, l->id.application, (uint16_t)(r->event + 1)};
}

static DisDescriptor descriptor(const FlightReport *r)
{
    return (DisDescriptor){r->of.type, 1000, 1000, 1, 0}; /* high explosive, contact fuse */
}

static void send_fire(const FlightReport *r, const FlightLoop *l, const LoopScene *scene, double t_s)
{
    uint8_t  bytes[pdu_room];
    LoopBody target;
    double   line[3] = {0};
    DisFire  pdu = {.header = header(r, dis_pdu_fire, warfare, t_s),
                    .firing = r->of.shooter,
                    .target = l->target,
                    .munition = l->id,
                    .event = event_of(r, l),
                    .descriptor = descriptor(r)};
    if (scene->body_at && scene->body_at(&target, scene->user, l->target, t_s)) v3_sub(line, target.p_ecef, l->p_ecef);
    pdu.range_m = (float)v3_length(line);
    for (int k = 0; k < 3; k++) {
        pdu.p_ecef[k] = l->p_ecef[k];
        pdu.velocity_mps[k] = (float)l->v_ecef_mps[k];
    }
    if (scene->fired) scene->fired(scene->user, &pdu, t_s);
    r->of.send(r->of.user, t_s, bytes, dis_encode_fire(bytes, sizeof bytes, &pdu));
}

/* Its motion at a tick; acceleration by the tick before, at which the launch has none. */
static void motion(Kinematics *out, const FlightReport *r, const FlightState *s, const FlightLoop *l)
{
    const double step_s = (double)(s->tick - r->before.tick) * l->world.step_s;
    *out = (Kinematics){.algorithm = algorithm_fvw};
    memcpy(out->p_ecef, s->p_ecef, sizeof out->p_ecef);
    memcpy(out->v_mps, s->v_ecef_mps, sizeof out->v_mps);
    memcpy(out->r_ecef_from_body, s->r_ecef_from_body, sizeof out->r_ecef_from_body);
    for (int k = 0; k < 3 && r->before_known && step_s > 0; k++)
        out->a_mps2[k] = (s->v_ecef_mps[k] - r->before.v_ecef_mps[k]) / step_s;
}

static void send_state(FlightReport *r, const FlightLoop *l, const Kinematics *k, uint32_t appearance, double t_s)
{
    DisEntityState es = {0};
    uint8_t        bytes[pdu_room];
    double         psi, theta, phi;
    char           marking[24];
    es.header = header(r, dis_pdu_entity_state, information, t_s);
    es.id = l->id;
    es.force = r->of.force;
    es.type = es.alternative_type = r->of.type;
    es.appearance = appearance;
    es.dead_reckoning = algorithm_fvw;
    es.marking_set = 1; /* ASCII */
    snprintf(marking, sizeof marking, "Missile %u", (unsigned)l->id.entity);
    memcpy(es.marking, marking, strlen(marking) < sizeof es.marking ? strlen(marking) : sizeof es.marking);
    euler_from_r_ecef_from_body(&psi, &theta, &phi, k->r_ecef_from_body);
    es.psi_rad = (float)psi, es.theta_rad = (float)theta, es.phi_rad = (float)phi;
    for (int i = 0; i < 3; i++) {
        es.p_ecef[i] = k->p_ecef[i];
        es.velocity_mps[i] = (float)k->v_mps[i];
        es.acceleration_mps2[i] = (float)k->a_mps2[i];
    }
    r->of.send(r->of.user, t_s, bytes, dis_encode_entity_state(bytes, sizeof bytes, &es));
    r->said = (Kinematics){.algorithm = algorithm_fvw};
    for (int i = 0; i < 3; i++) {
        r->said.p_ecef[i] = es.p_ecef[i];
        r->said.v_mps[i] = es.velocity_mps[i];
        r->said.a_mps2[i] = es.acceleration_mps2[i];
    }
    r_ecef_from_body_euler(r->said.r_ecef_from_body, es.psi_rad, es.theta_rad, es.phi_rad);
    r->said_s = t_s;
    r->known = true;
    r->states++;
}

static bool due(const FlightReport *r, const Kinematics *now, double t_s)
{
    Motion believed;
    double off[3], turn[9];
    if (!r->known || t_s - r->said_s >= r->of.heartbeat_s - 1e-6) return true;
    dead_reckon(&believed, &r->said, t_s - r->said_s);
    v3_sub(off, believed.p_ecef, now->p_ecef);
    m3_tmul(turn, believed.r_ecef_from_body, now->r_ecef_from_body);
    const double skew[3] = {turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]};
    const double angle_rad = atan2(0.5 * v3_length(skew), 0.5 * (turn[0] + turn[4] + turn[8] - 1));
    return !(v3_length(off) < r->of.threshold_m) || !(angle_rad < r->of.threshold_rad);
}

static void send_detonation(const FlightReport *r, const FlightLoop *l, const LoopScene *scene)
{
    DisDetonation pdu = {0};
    uint8_t       bytes[pdu_room];
    LoopBody      target;
    double        off[3], off_body[3];
    pdu.header = header(r, dis_pdu_detonation, warfare, l->end_s);
    pdu.firing = r->of.shooter;
    pdu.munition = l->id;
    pdu.event = event_of(r, l);
    pdu.descriptor = descriptor(r);
    pdu.result = (uint8_t)(l->hit                        ? dis_result_entity_impact
                           : l->end == FLIGHT_END_GROUND ? dis_result_ground_impact
                                                         : dis_result_none);
    for (int k = 0; k < 3; k++) {
        pdu.p_ecef[k] = l->end_ecef[k];
        pdu.velocity_mps[k] = (float)l->state.v_ecef_mps[k];
    }
    if (l->hit) {
        pdu.target = l->target;
        if (scene->body_at && scene->body_at(&target, scene->user, l->target, l->end_s)) {
            v3_sub(off, l->end_ecef, target.p_ecef);
            m3_tmul_v3(off_body, target.r_ecef_from_body, off);
            for (int k = 0; k < 3; k++) pdu.p_target_m[k] = (float)off_body[k];
        }
    }
    r->of.send(r->of.user, l->end_s, bytes, dis_encode_detonation(bytes, sizeof bytes, &pdu));
    if (scene->burst) scene->burst(scene->user, &pdu, l->end_s);
}

void flight_report_tick(FlightReport *r, const FlightLoop *l, const LoopScene *scene, double t_s)
{
    Kinematics now;
    if (r->closed) return;
    if (!r->known) {
        send_fire(r, l, scene, (double)l->launch_tick * l->world.step_s);
        if (l->track_count > 0) { /* the launch itself */
            motion(&now, r, &l->track[0], l);
            send_state(r, l, &now, 0, (double)l->launch_tick * l->world.step_s);
            r->before = l->track[0];
            r->before_known = true;
        }
    }
    motion(&now, r, &l->state, l);
    r->before = l->state;
    r->before_known = true;
    if (!l->ended) { /* one that went off is followed to its closest approach, unseen */
        if (!l->miss.fuzed && t_s > r->said_s && due(r, &now, t_s)) send_state(r, l, &now, 0, t_s);
        return;
    }
    send_detonation(r, l, scene);
    memcpy(now.p_ecef, l->end_ecef, sizeof now.p_ecef);
    send_state(r, l, &now, 1u << dis_appearance_deactivated_bit, l->end_s);
    r->closed = true;
}

void flight_report_next(FlightReport *r)
{
    r->event++;
    r->known = r->closed = r->before_known = false;
}
