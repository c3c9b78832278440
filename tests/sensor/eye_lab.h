/* tests/sensor/eye_lab.h: sessions over hand-made reports on flat ground: what the camera does in each frame, for tests
 * with closed forms. */
#ifndef TESTS_SENSOR_EYE_LAB_H
#define TESTS_SENSOR_EYE_LAB_H

#include "tests/check.h"
#include "tests/sensor/attitude.h"

#include "dis/pdu/decode.h"
#include "entities/motion/dead_reckoning.h"
#include "sensor/node/clock/log_clock.h"
#include "sensor/node/session/session.h"

enum { lab_most_reports = 512, lab_most_frames = 512, lab_octets = 256 };

typedef struct LabFrame {
    double      t_s, p_enu[3], r_enu_from_cam[9], rate_px_s[2], focal_px;
    bool        at_limit;
    DisEntityId host;
    int         target_samples;
    char        given_up[16];
} LabFrame;

static struct {
    LocalFrame    frame;
    Landscape     ground;
    Catalog      *catalog;
    World         world;
    Pool         *pool;
    uint8_t       octets[lab_most_reports][lab_octets];
    DisDatagram   datagram[lab_most_reports];
    int           reports;
    LabFrame      shot[lab_most_frames];
    int           shots;
    char          folder[temp_path_size];
    SessionResult result;
    double        first_s;
    /* of the next runs */
    FrameClock *clock;          /* NULL: that of its span */
    bool        adaptive, live; /* rays by antialias: adaptive; as a live node */
    const char *notes;          /* SessionShared's, as these two */
    void (*note)(void *user, const char *text);
    unsigned (*choose)(void *user, const FrameTime *frame);
    const InstrumentKind *const *kinds;           /* NULL: the program's */
    void (*look)(void *user, const Frame *frame); /* at each frame, in place of lab_shoot; NULL: that */
} lab;

static inline int lab_open(void **state)
{
    (void)state;
    char            path[512];
    const Geodetic  origin = {48 * rad_per_deg, 11 * rad_per_deg, 0};
    LandscapeConfig config = landscape_default_config();
    config.relief_m = 0;
    config.half_width_m = 600;
    if (local_frame_at(&lab.frame, &origin) != STATUS_OK || pool_create(&lab.pool, 2) != STATUS_OK) return -1;
    if (landscape_create(&lab.ground, &config, &lab.frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (!etc_path(path, sizeof path, "catalog.csv") || catalog_open(&lab.catalog, path, 0.05) != STATUS_OK) return -1;
    if (world_open(&lab.world, lab.catalog, &lab.ground, &lab.frame, "avx2") != STATUS_OK) return -1;
    strcpy(lab.folder, "/tmp/pitviper-eye-XXXXXX");
    return atmosphere_open(&lab.world.atmosphere, "us1976") == STATUS_OK && mkdtemp(lab.folder) ? 0 : -1;
}

static inline int lab_close(void **state)
{
    (void)state;
    char path[temp_path_size + 16];
    snprintf(path, sizeof path, "%s/truth.jsonl", lab.folder);
    remove(path);
    rmdir(lab.folder);
    world_close(&lab.world);
    landscape_destroy(&lab.ground);
    catalog_close(lab.catalog);
    pool_destroy(lab.pool);
    return 0;
}

/* A report at t_s; what is not said is zero. */
typedef struct LabReport {
    double        t_s;
    uint16_t      entity;
    DisEntityType type;
    double        p_enu[3], v_enu_mps[3], r_enu_from_body[9], w_body_rps[3];
    uint32_t      appearance;
    double        turret_rad, gun_rad; /* 0: not reported */
} LabReport;

static inline void lab_say(const LabReport *r)
{
    double         v_ecef[3], r_ecef[9], psi, theta, phi;
    DisEntityState pdu = {.header = {.version = 7,
                                     .exercise = 1,
                                     .type = dis_pdu_entity_state,
                                     .family = 1,
                                     .timestamp = (uint32_t)(r->t_s / 3600 * 2147483648.0) << 1},
                          .id = {1, 1, r->entity},
                          .type = r->type,
                          .appearance = r->appearance,
                          .dead_reckoning = 3}; /* RPW */
    CHECK(lab.reports < lab_most_reports);
    ecef_from_enu(pdu.p_ecef, &lab.frame, r->p_enu);
    m3_mul_v3(v_ecef, lab.frame.r_ecef_from_enu, r->v_enu_mps);
    m3_mul(r_ecef, lab.frame.r_ecef_from_enu, r->r_enu_from_body);
    euler_from_r_ecef_from_body(&psi, &theta, &phi, r_ecef);
    pdu.psi_rad = (float)psi, pdu.theta_rad = (float)theta, pdu.phi_rad = (float)phi;
    for (int k = 0; k < 3; k++) {
        pdu.velocity_mps[k] = (float)v_ecef[k];
        pdu.angular_rate_rps[k] = (float)r->w_body_rps[k];
    }
    if (r->turret_rad != 0)
        pdu.variable[pdu.variable_count++] = (DisVariableParameter){
            .record_type = dis_variable_articulated, .parameter = 4096 + 11, .value = (float)r->turret_rad};
    if (r->gun_rad != 0)
        pdu.variable[pdu.variable_count++] = (DisVariableParameter){
            .record_type = dis_variable_articulated, .parameter = 4416 + 13, .value = (float)r->gun_rad};
    const int    n = lab.reports++;
    const size_t octets = dis_encode_entity_state(lab.octets[n], lab_octets, &pdu);
    CHECK(octets > 0);
    lab.datagram[n] = (DisDatagram){.capture_s = 1e9 + r->t_s,
                                    .packet_s = 1e9 + r->t_s,
                                    .packet = (uint32_t)n + 1,
                                    .octets = (uint32_t)octets,
                                    .bytes = lab.octets[n]};
}

/* A Stop/Freeze or Start/Resume of all, at t_s. */
static inline void lab_pause(double t_s, bool stop)
{
    const DisEntityId all = {0xFFFF, 0xFFFF, 0xFFFF};
    const int         n = lab.reports++;
    CHECK(n < lab_most_reports);
    DisHeader header = {
        .version = 7, .exercise = 1, .family = 5, .timestamp = (uint32_t)(t_s / 3600 * 2147483648.0) << 1};
    size_t octets;
    header.type = stop ? dis_pdu_stop_freeze : dis_pdu_start_resume;
    if (stop)
        octets = dis_encode_stop_freeze(lab.octets[n], lab_octets,
                                        &(DisStopFreeze){.header = header, .originating = {1, 1, 0}, .receiving = all});
    else
        octets = dis_encode_start_resume(
            lab.octets[n], lab_octets, &(DisStartResume){.header = header, .originating = {1, 1, 0}, .receiving = all});
    CHECK(octets > 0);
    lab.datagram[n] = (DisDatagram){.capture_s = 1e9 + t_s,
                                    .packet_s = 1e9 + t_s,
                                    .packet = (uint32_t)n + 1,
                                    .octets = (uint32_t)octets,
                                    .bytes = lab.octets[n]};
}

static inline void lab_forget(void) { lab.reports = 0; }

static inline void lab_shoot(void *user, const Frame *frame)
{
    const FrameRecord *record = &frame->record;
    (void)user;
    CHECK(lab.shots < lab_most_frames);
    LabFrame *shot = &lab.shot[lab.shots++];
    *shot = (LabFrame){.t_s = record->time_s,
                       .focal_px = record->request->view.focal_px,
                       .at_limit = record->gimbal_at_limit,
                       .target_samples = record->request->target_samples,
                       .rate_px_s = {record->scene_rate_px_s[0], record->scene_rate_px_s[1]}};
    if (record->host) shot->host = record->host->id;
    if (record->given_up) snprintf(shot->given_up, sizeof shot->given_up, "%s", record->given_up);
    enu_from_ecef(shot->p_enu, &lab.frame, record->p_eye_ecef);
    m3_tmul(shot->r_enu_from_cam, lab.frame.r_ecef_from_enu, record->r_ecef_from_cam);
}

static inline bool lab_over(void *user)
{
    (void)user;
    return false;
}

static inline Status lab_make(void *user, const FrameTime *frame)
{
    bool shown;
    return session_frame(&shown, user, frame);
}

static inline int lab_compare(const void *a, const void *b)
{
    const DisDatagram *p = a, *q = b;
    return p->capture_s < q->capture_s ? -1 : p->capture_s > q->capture_s;
}

/* Frames at rate_hz from from_s on, seconds after the first report, of a small picture of the field of view that config
 * says. */
static inline void lab_run(const Config *given, double from_s, double rate_hz, int frames)
{
    Config   config = *given;
    Survey   survey;
    HostPlan plan;
    Choices  choices = {0};
    Player  *player = NULL;
    Session *session = NULL;
    Sensors  sensors = {0};
    config.sensor.width_px = 24, config.sensor.height_px = 16;
    config.publish.files = config.publish.png = false;
    if (!lab.adaptive) config.sensor.antialias = ANTIALIAS_OFF;
    config.quality.budget = false;
    qsort(lab.datagram, (size_t)lab.reports, sizeof *lab.datagram, lab_compare);
    DisLog log = {.count = lab.reports, .datagram = lab.datagram};
    assert_int_equal(survey_log(&survey, &log, -1), STATUS_OK);
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    if (config.exercise.causal) plan.start_s = survey.first_s, plan.end_s = INFINITY;
    assert_int_equal(player_create(&player, -1, config.exercise.causal), STATUS_OK);
    assert_int_equal(player_add_log(player, &log), STATUS_OK);
    const SessionShared shared = {.config = &config,
                                  .survey = &survey,
                                  .catalog = lab.catalog,
                                  .world = &lab.world,
                                  .pool = lab.pool,
                                  .unix_s = 1782036000,
                                  .bands = 1u << BAND_LWIR,
                                  .config_sha256 = "",
                                  .sensors = &sensors,
                                  .instruments = lab.kinds ? lab.kinds : instrument_kinds,
                                  .publish = lab.look ? lab.look : lab_shoot,
                                  .live = lab.live,
                                  .note = lab.note,
                                  .notes = lab.notes,
                                  .choose = lab.choose};
    assert_int_equal(session_open(&session, &shared, &plan, player, lab.folder), STATUS_OK);
    lab.shots = 0;
    lab.first_s = survey.first_s;
    bool     over;
    LogClock clock = log_clock(INFINITY);
    /* on ticks, to the bit */
    log_clock_begin(&clock,
                    &(LogSpan){{rint((survey.first_s + from_s) * rate_hz), rate_hz}, 0, frames - 1, NULL, 0, NAN});
    assert_int_equal(
        frame_loop(&over, &(FrameLoop){lab.clock ? lab.clock : &clock.clock, lab_over, NULL, lab_make, session}),
        STATUS_OK);
    session_result_free(&lab.result);
    assert_int_equal(session_close(session, &lab.result), STATUS_OK);
    player_destroy(player);
    survey_destroy(&survey);
}

#endif
