/* sensor/node/flight/node_flight.c: a node's own missiles: launches, hand-overs, notes, and what came of them. */
#include "sensor/node/flight/node_flight.h"

#include "dis/capture/recorder.h"
#include "dis/clock/exercise_clock.h"
#include "entities/exercise/scenario.h"
#include "pitviper_output.h"
#include "sensor/node/flight/flight_note.h"
#include "sensor/node/flight/flight_report.h"
#include "sensor/node/flight/operator_sight.h"
#include "terrain/earth/geodesy.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

enum { path_size = 4200 };
static const int64_t never = INT64_MAX / 4;

/* What came of one, for flight.csv. */
typedef struct Flown {
    DisEntityId id;
    double      fire_s, end_s, miss_m, end_mps, most_lateral_mps2, guided_share;
    bool        hit;
    FlightEnd   end;
    int         seen;
} Flown;

struct NodeFlight {
    NodeFlightOf   of;
    const Config  *config;
    FlightHooks    hooks;
    FlightLoop     loop;
    FlightReport   report;
    DisEntityId    shooter; /* 0:0:0: from place_ecef */
    double         place_ecef[3];
    int            round;   /* from 0 */
    double         armed_s; /* not launched before; NAN: it waits for the frame that says so */
    double         first_s; /* exercise time of the first launch */
    FlightNote    *noted;   /* [noted_count] NULL: none */
    int            noted_count, noted_next;
    bool           replays;  /* by notes */
    double         frame_s;  /* of the last frame */
    bool           looked;   /* its eye has been asked for */
    OperatorSight *operator; /* NULL: there is none */
    DisRecorder   *recorder;
    Status         status; /* of files: the first failure */
    Flown          flown[node_flight_rounds_most];
};

/* ---- what is sent ------------------------------------------------------------------------------------ */

static uint32_t stamp(void *user, double t_s)
{
    const NodeFlight *n = user;
    return dis_timestamp(n->of.arrival_s(n->of.clock, t_s), false);
}

static void sent(void *user, double t_s, const uint8_t *pdu, size_t octets)
{
    NodeFlight   *n = user;
    char          path[path_size];
    const int64_t arrival_ns = llround(1e9 * n->of.arrival_s(n->of.clock, t_s));
    if (!n->recorder && n->status == STATUS_OK) {
        snprintf(path, sizeof path, "%s/flight.pcapng", n->of.folder);
        n->status = dis_recorder_open(&n->recorder, path, "pitviper: what its missile sends");
    }
    if (n->recorder && dis_recorder_add(n->recorder, arrival_ns, NULL, dis_port, pdu, octets) != STATUS_OK)
        n->status = STATUS_IO;
    if (n->of.send) n->of.send(n->of.user, pdu, octets); /* counted by the sender */
}

/* ---- launch ------------------------------------------------------------------------------------------ */

static void note_launch(NodeFlight *n)
{
    char text[flight_note_size];
    if (!n->of.note) return;
    flight_note_text(text, &(FlightNote){.launch = true, .tick = n->loop.launch_tick});
    n->of.note(n->of.user, text);
}

/* The direction of launch: to the target, or steeper by the loft's angle; and the speed of the row, which a shooter
 * that is faster already has. */
static bool launch_velocity(double v_ecef_mps[3], const NodeFlight *n, const double p_ecef[3],
                            const double target_ecef[3])
{
    const Missile *m = &n->loop.missile;
    Geodetic       place;
    double         line[3], level[3];
    v3_sub(line, target_ecef, p_ecef);
    if (!v3_normalize(line, line) || geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return false;
    const double up[3] = {cos(place.lat_rad) * cos(place.lon_rad), cos(place.lat_rad) * sin(place.lon_rad),
                          sin(place.lat_rad)};
    v3_add_scaled(level, line, -v3_dot(line, up), up);
    if (m->guidance == MISSILE_LOFT && v3_normalize(level, level)) {
        v3_scale(line, cos(m->loft_rad), level);
        v3_add_scaled(line, line, sin(m->loft_rad), up);
    }
    v3_add_scaled(v_ecef_mps, v_ecef_mps, fmax(0, m->launch_mps - v3_dot(v_ecef_mps, line)), line);
    return true;
}

/* 2 m above the shooter's origin, as a gun's trunnions; below the wing of an aircraft it is its own matter. */
static bool launch_at(void *user, const LoopScene *scene, double tick_s, const double target_ecef[3])
{
    static const double above_m = 2;
    NodeFlight         *n = user;
    FlightLoop         *l = &n->loop;
    LoopBody            from = {0};
    if (!target_ecef) return false;
    if (dis_entity_id_is_none(n->shooter)) memcpy(from.p_ecef, n->place_ecef, sizeof from.p_ecef);
    else if (!scene->body_at(&from, scene->user, n->shooter, tick_s)) return false;
    else
        for (int k = 0; k < 3; k++) from.p_ecef[k] -= above_m * from.r_ecef_from_body[3 * k + 2];
    memcpy(l->p_ecef, from.p_ecef, sizeof l->p_ecef);
    memcpy(l->v_ecef_mps, from.v_ecef_mps, sizeof l->v_ecef_mps);
    if (!launch_velocity(l->v_ecef_mps, n, l->p_ecef, target_ecef)) return false;
    l->launch_tick = llround(tick_s / l->world.step_s); /* a tick of the node: where everything is known */
    if (n->round == 0) n->first_s = tick_s;
    log_info("flight: %u:%u:%u %s launched at %.2f s", l->id.site, l->id.application, l->id.entity, l->missile.name,
             tick_s);
    return true;
}

/* ---- one after the other ------------------------------------------------------------------------------ */

static void conclude(NodeFlight *n)
{
    const FlightLoop *l = &n->loop;
    if (n->round >= node_flight_rounds_most) return;
    n->flown[n->round] =
        (Flown){.id = l->id,
                .fire_s = (double)l->launch_tick * l->world.step_s,
                .end_s = l->end_s,
                .miss_m = l->miss.least_m,
                .end_mps = v3_length(l->state.v_ecef_mps),
                .most_lateral_mps2 = l->most_lateral_mps2,
                .guided_share = (double)l->guided / (double)(l->guided + l->coasted + !(l->guided + l->coasted)),
                .hit = l->hit,
                .end = l->end,
                .seen = l->verdicts[LOOP_SEEN]};
    n->round++;
    log_info("flight: %u:%u:%u ended at %.2f s: %s, closest approach %.3g m", l->id.site, l->id.application,
             l->id.entity, l->end_s, flight_end_name(l->end), l->miss.least_m);
}

/* The next missile takes the frame, when the one before has ended. */
static void hand_over(NodeFlight *n)
{
    FlightLoop *l = &n->loop;
    if (!l->ended || !n->report.closed || n->round >= n->config->flight.rounds) return;
    conclude(n);
    if (n->round >= n->config->flight.rounds) return;
    flight_loop_next(l);
    flight_report_next(&n->report);
    l->launch_tick = never;
    l->id.entity++;
    n->armed_s = isnan(n->first_s) ? NAN : n->first_s + n->round * n->config->flight.every_s;
}

/* ---- hooks ------------------------------------------------------------------------------------------- */

/* What is noted until t_s; inclusive: also what was taken at a frame of that time, before it was made. */
static void take_notes(NodeFlight *n, double t_s, bool inclusive)
{
    while (n->noted_next < n->noted_count) {
        const FlightNote *note = &n->noted[n->noted_next];
        FlightLoop       *l = &n->loop;
        if (note->launch) {
            if (l->launched && l->ended) hand_over(n);
            if (l->launched || (double)note->tick * l->world.step_s > t_s + 1e-9) return;
            l->launch_tick = note->tick;
        } else {
            if (!(note->taken_s < t_s || (inclusive && note->taken_s == t_s && !note->after))) return;
            loop_push(l, &note->usable);
        }
        n->noted_next++;
    }
}

static void operate(NodeFlight *n)
{
    OperatorAim aim;
    FlightLoop *l = &n->loop;
    double      los[3];
    if (!n->operator|| !operator_sight_newest(&aim, n->operator)) return;
    if (aim.launch && isnan(n->armed_s)) n->armed_s = -INFINITY;
    const bool steers = n->config->flight.sight == FLIGHT_SIGHT_OPERATOR;
    if (!steers || !l->launched || l->ended || !operator_direction(los, &aim, l->eye.p_ecef)) return;
    if (loop_sights_direct(l, los, NAN, NAN)) l->verdicts[LOOP_SEEN]++;
}

/* Before a frame of a node that does not fly by notes. */
static void boundary(void *user, double t_s)
{
    NodeFlight *n = user;
    FlightLoop *l = &n->loop;
    n->frame_s = t_s;
    n->looked = false;
    if (n->replays) return;
    l->least_from_s = t_s;
    if (l->launched && !l->ended && l->source == LOOP_ANSWERS) loop_sights_arrived(l, t_s);
    l->least_from_s = t_s;
    operate(n);
    l->least_from_s = -INFINITY;
    hand_over(n);
    if (!l->launched && l->launch_tick == never && !isnan(n->armed_s))
        l->launch_tick = (int64_t)ceil(fmax(n->armed_s, t_s) / l->world.step_s - 1e-6);
}

static void before(void *user, double tick_s)
{
    NodeFlight *n = user;
    if (n->replays) take_notes(n, tick_s, false);
}

static void flown(void *user, const LoopScene *scene, double tick_s)
{
    NodeFlight *n = user;
    FlightLoop *l = &n->loop;
    if (!n->report.known && !n->replays) note_launch(n);
    flight_report_tick(&n->report, l, scene, tick_s);
    l->over = l->ended && n->round + 1 >= n->config->flight.rounds;
}

static void look(void *user, double t_s)
{
    NodeFlight *n = user;
    n->looked = true;
    if (n->replays) take_notes(n, t_s, true);
}

static void taken(void *user, const LoopUsable *usable)
{
    NodeFlight *n = user;
    char        text[flight_note_size];
    if (n->replays || !n->of.note) return;
    flight_note_text(text, &(FlightNote){.taken_s = n->frame_s, .after = n->looked, .usable = *usable});
    n->of.note(n->of.user, text);
}

/* ---- begin and end ------------------------------------------------------------------------------------ */

static const LoopSource source_of[] = {
    [FLIGHT_SIGHT_TRUTH] = LOOP_TRUE,
    [FLIGHT_SIGHT_RECOGNISER] = LOOP_ANSWERS,
    [FLIGHT_SIGHT_RADAR] = LOOP_RADAR,
    [FLIGHT_SIGHT_OPERATOR] = LOOP_GIVEN, /* pushed as they come */
};

static Status read_row(Missile *out, const Config *config)
{
    char path[path_size];
    if (!etc_path(path, sizeof path, "missiles.csv")) return STATUS_BAD_VALUE;
    return missile_read(out, path, config->flight.missile);
}

/* LAT,LON,HEIGHT. */
static bool read_place(double p_ecef[3], const char *text)
{
    double deg[2], h_m;
    int    used = 0;
    if (sscanf(text, "%lf,%lf,%lf%n", &deg[0], &deg[1], &h_m, &used) != 3 || text[used]) return false;
    if (!(fabs(deg[0]) <= 90 && fabs(deg[1]) <= 180 && h_m >= -1000 && h_m <= 50000)) return false;
    const Geodetic place = {deg[0] * rad_per_deg, deg[1] * rad_per_deg, h_m};
    return ecef_from_geodetic(p_ecef, NULL, &place) == STATUS_OK;
}

bool flight_mount_good(const Config *config)
{
    static const char *const pointed[] = {"gimbal_limit_deg", "gimbal_rate_dps", "gimbal_lag_s", "mount",
                                          "mount_x_m",        "mount_y_m",       "mount_z_m",    "mount_yaw_deg",
                                          "mount_pitch_deg"};
    char                     key[40];
    for (size_t i = 0; i < sizeof pointed / sizeof *pointed; i++) {
        snprintf(key, sizeof key, "sensor.%s", pointed[i]);
        if (!config_given(config, key)) continue;
        log_error("flight: %s: the eye is the point that flies, and its gimbal that of the missile's row (gimbal_deg, "
                  "gimbal_rate_dps of etc/missiles.csv): leave it out",
                  key);
        return false;
    }
    return true;
}

Status node_flight_check(const Config *config, bool live)
{
    Missile       row;
    DisEntityId   id;
    DisEntityType type;
    double        p[3];
    const int     sight = config->flight.sight;
    if (!flight_mount_good(config)) return STATUS_BAD_VALUE;
    if (!dis_entity_id_parse(&id, config->flight.from) && !read_place(p, config->flight.from)) {
        log_error(
            "flight: flight.from: '%s' is neither the shooter, site:application:entity, nor a place, LAT,LON,HEIGHT in "
            "degrees and metres above the ellipsoid",
            config->flight.from);
        return STATUS_BAD_VALUE;
    }
    if (!scenario_type_parse(&type, config->flight.type)) {
        log_error("flight: flight.type: '%s' is not kind.domain.country.category.subcategory.specific.extra",
                  config->flight.type);
        return STATUS_BAD_VALUE;
    }
    const Status status = read_row(&row, config);
    if (status != STATUS_OK) return status;
    const char *wrong = row.guidance == MISSILE_COMMAND
                            ? "flight.missile: this row is commanded from its launcher and has "
                              "no seeker, whose frames could guide it"
                        : *config->exercise.cigi ? "flight.missile: a CIGI host moves the eye: without exercise.cigi"
                        : *config->exercise.host && strcmp(config->exercise.host, "observer") != 0
                            ? "flight.missile: the missile is the host: leave exercise.host (--host) out"
                        : !*config->exercise.aim ? "flight.missile: exercise.aim says what it flies at: "
                                                   "site:application:entity"
                        : sight == FLIGHT_SIGHT_RECOGNISER && !config->publish.detections_port && live
                            ? "flight.sight: recogniser: publish.detections_port is where its answers come: not 0"
                        : sight == FLIGHT_SIGHT_OPERATOR && !config->flight.operator_port && live
                            ? "flight.sight: operator: flight.operator_port is where the operator's aim comes: not 0"
                        : config->flight.key && !config->flight.operator_port && live
                            ? "flight.key: flight.operator_port is where the operator's key comes: not 0"
                        : config->flight.operator_port && !config->flight.key && sight != FLIGHT_SIGHT_OPERATOR
                            ? "flight.operator_port: an operator is for flight.sight: operator, or flight.key"
                        : sight == FLIGHT_SIGHT_RADAR && strcmp(config->radar.preset, "none") == 0
                            ? "flight.sight: radar: radar.preset is the seeker's radar: not none"
                            : NULL;
    if (!wrong) return STATUS_OK;
    log_error("flight: %s", wrong);
    return STATUS_BAD_VALUE;
}

static Status begin(NodeFlight *n)
{
    const Config *config = n->config;
    FlightLoop   *l = &n->loop;
    Status        status = read_row(&l->missile, config);
    if (status == STATUS_OK) status = flight_notes_read(&n->noted, &n->noted_count, n->of.live ? NULL : n->of.notes);
    if (status != STATUS_OK) return status;
    n->replays = n->noted_count > 0;
    if (!n->of.live && !n->replays &&
        (config->flight.sight == FLIGHT_SIGHT_RECOGNISER || config->flight.sight == FLIGHT_SIGHT_OPERATOR)) {
        log_error(
            "flight: flight.sight: this recording has no notes of a flight (`pitviper run --fly ROW --record LOG`, a "
            "pcapng), and a replay does not wait for answers: truth or radar, or `pitviper fly`");
        return STATUS_BAD_VALUE;
    }
    l->source = n->replays ? LOOP_GIVEN : source_of[config->flight.sight];
    l->missile.fuze_m = fmax(l->missile.fuze_m, config->flight.hit_m);
    l->id =
        (DisEntityId){(uint16_t)config->node.site, (uint16_t)config->node.application, (uint16_t)config->flight.entity};
    l->target = n->of.target;
    l->late_s = config->flight.late_s;
    l->memory = config->flight.memory;
    l->launch_tick = never;
    n->armed_s = config->flight.key ? NAN : isnan(config->flight.at_s) ? -INFINITY : config->flight.at_s;
    n->first_s = NAN;
    if (!dis_entity_id_parse(&n->shooter, config->flight.from)) {
        n->shooter = (DisEntityId){0};
        if (!read_place(n->place_ecef, config->flight.from)) return STATUS_BAD_VALUE;
    }
    n->report.of = (FlightReportOf){.version = n->of.version,
                                    .exercise = n->of.exercise,
                                    .shooter = n->shooter,
                                    .force = (uint8_t)config->flight.force,
                                    .threshold_m = config->flight.threshold_m,
                                    .threshold_rad = config->flight.threshold_deg * rad_per_deg,
                                    .heartbeat_s = config->flight.heartbeat_s,
                                    .user = n,
                                    .stamp = stamp,
                                    .send = sent};
    if (!scenario_type_parse(&n->report.of.type, config->flight.type)) return STATUS_BAD_VALUE;
    if (n->of.live && config->flight.operator_port)
        return operator_sight_open(&n->operator, config->flight.operator_port);
    return STATUS_OK;
}

Status node_flight_open(NodeFlight **out, const NodeFlightOf *of)
{
    NodeFlight *n = calloc(1, sizeof *n);
    if (!n) return STATUS_NO_MEMORY;
    n->of = *of;
    n->config = of->config;
    n->hooks = (FlightHooks){n, boundary, before, launch_at, flown, look, taken};
    n->loop.hooks = &n->hooks;
    Status status = begin(n);
    if (status == STATUS_OK) status = flight_loop_begin(&n->loop);
    if (status != STATUS_OK) {
        operator_sight_close(n->operator);
        free(n->noted);
        free(n);
        return status;
    }
    *out = n;
    return STATUS_OK;
}

FlightLoop *node_flight_loop(NodeFlight *n) { return &n->loop; }

static Status write_table(const NodeFlight *n)
{
    char path[path_size];
    snprintf(path, sizeof path, "%s/flight.csv", n->of.folder);
    FILE *file = output_begin(path, 0);
    if (file) {
        fputs("round,munition,missile,fire_s,flight_s,hit,end,miss_m,end_mps,most_lateral_mps2,guided_share\n", file);
        for (int i = 0; i < n->round && i < node_flight_rounds_most; i++) {
            const Flown *f = &n->flown[i];
            fprintf(file, "%d,%u:%u:%u,%s,%.3f,%.6f,%s,%s,%.6g,%.2f,%.2f,%.4f\n", i + 1, f->id.site, f->id.application,
                    f->id.entity, n->loop.missile.name, f->fire_s, f->end_s - f->fire_s,
                    f->hit                        ? "entity"
                    : f->end == FLIGHT_END_GROUND ? "ground"
                                                  : "none",
                    flight_end_name(f->end), f->miss_m, f->end_mps, f->most_lateral_mps2, f->guided_share);
        }
        if (output_end(file, path)) return STATUS_OK;
    }
    log_error("flight: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

Status node_flight_close(NodeFlight *n)
{
    if (!n) return STATUS_OK;
    Status status = n->status;
    if (n->loop.ended && n->report.closed && n->round < n->config->flight.rounds) conclude(n);
    else if (n->loop.launched && !n->loop.ended) log_warn("flight: the missile is still in the air when the run ends");
    loop_sights_say_refused(&n->loop);
    if (n->loop.out_of_memory) status = STATUS_NO_MEMORY;
    if (n->recorder && dis_recorder_close(n->recorder) != STATUS_OK) status = STATUS_IO;
    if (status == STATUS_OK && n->recorder) status = write_table(n);
    operator_sight_close(n->operator);
    flight_loop_free(&n->loop);
    free(n->noted);
    free(n);
    return status;
}
