/* An instrument is one file and one row of a list of kinds (etc/ADDING.md, "An instrument", shows this one): a gauge of
 * ranges, two of them in one session. It asks for its planes, its arrays and records reach a consumer and are those of
 * a level ground, its poses at other times are those of the host's motion, and what it leaves out is counted with its
 * reason. */
#include "tests/adding_snippet.h"
#include "tests/sensor/eye_lab.h"

#include "sensor/instruments/camera.h"

/* ---- the instrument: the least and the mean range of some rows of the picture -------------------------- */

enum { gauge_rows = 8, gauge_frames = 6 };

static const double gauge_ahead_s = 0.125;

typedef struct Gauge {
    Instrument instrument;
    int        first_row, looks;
    bool       rests; /* in every other frame */
} Gauge;

typedef struct GaugeRecord {
    int    looks;
    double eye_m[3], entity_m[3]; /* ENU, from the frame's time to gauge_ahead_s after it */
} GaugeRecord;

static const InstrumentKind gauge_kind;
static int                  gauges_closed;

static void gauge_moved(double out[3], const double to_ecef[3], const double from_ecef[3])
{
    double way[3];
    v3_sub(way, to_ecef, from_ecef);
    m3_tmul_v3(out, lab.frame.r_ecef_from_enu, way);
}

static Status gauge_add(Instruments *list, const char *name, int first_row, bool rests)
{
    Gauge *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    *g = (Gauge){.instrument = {&gauge_kind, name}, .first_row = first_row, .rests = rests};
    return instruments_add(list, &g->instrument);
}

static Status gauge_open(Instruments *list, const InstrumentsOf *of)
{
    CHECK(of->config && of->sensors);
    const Status status = gauge_add(list, "upper", 0, true);
    return status == STATUS_OK ? gauge_add(list, "lower", gauge_rows, false) : status;
}

static void gauge_request(RenderRequest *request, const Instrument *instrument, unsigned wants)
{
    (void)instrument;
    (void)wants;
    request->truth = true;
}

static Status gauge_look(FrameOutput *out, Instrument *instrument, const InstrumentLook *look)
{
    Gauge         *g = (Gauge *)instrument;
    Frame         *f = look->frame;
    const Picture *p = &f->seen.picture;
    g->looks++;
    if (g->rests && g->looks % 2 == 0) {
        out->left_out = "it rests";
        return STATUS_OK;
    }
    double      *range_m = arena_alloc(f->arena, (size_t)2 * gauge_rows, sizeof *range_m);
    FrameArray  *array = arena_alloc(f->arena, 1, sizeof *array);
    GaugeRecord *record = arena_alloc(f->arena, 1, sizeof *record);
    if (!range_m || !array || !record) return STATUS_NO_MEMORY;
    for (int row = 0; row < gauge_rows; row++) {
        const float *line = p->range_m + (size_t)(g->first_row + row) * (size_t)p->width;
        double       least = INFINITY, sum = 0;
        for (int x = 0; x < p->width; x++) least = fmin(least, line[x]), sum += line[x];
        range_m[2 * row] = least;
        range_m[2 * row + 1] = sum / p->width;
    }
    *array = (FrameArray){.group = out->name,
                          .name = "range_m",
                          .unit = "m",
                          .kind = PLANE_TRUTH,
                          .type = PLANE_F64,
                          .axes = 2,
                          .axis = {"row", "least, mean"},
                          .size = {gauge_rows, 2},
                          .values = range_m};
    *record = (GaugeRecord){.looks = g->looks};
    EyeState               eye;
    SnapshotEntity         there;
    const SnapshotEntity  *host = f->record.host;
    const InstrumentPoses *poses = &look->poses;
    CHECK(host && poses->eye(&eye, poses->of, f->time_s + gauge_ahead_s));
    CHECK(poses->entity(&there, poses->of, host->id, f->time_s + gauge_ahead_s));
    CHECK(!poses->entity(&there, poses->of, (DisEntityId){9, 9, 9}, f->time_s));
    CHECK(poses->entity(&there, poses->of, host->id, f->time_s + gauge_ahead_s));
    gauge_moved(record->eye_m, eye.p_ecef, look->eye->p_ecef);
    gauge_moved(record->entity_m, there.p_ecef, host->p_ecef);
    out->arrays = 1;
    out->array = array;
    out->record = record;
    return STATUS_OK;
}

static void gauge_close(Instrument *instrument)
{
    gauges_closed++;
    free(instrument);
}

static const InstrumentKind gauge_kind = {
    .name = "gauge", .open = gauge_open, .request = gauge_request, .look = gauge_look, .close = gauge_close};

/* Its one line elsewhere. */
static const InstrumentKind *const with_gauges[] = {&camera_kind, &gauge_kind, NULL}; /* as instrument_kinds */

/* ---- what a consumer gets ------------------------------------------------------------------------------- */

static int frames_with_truth, arrays_seen;

/* Where the rays of a row meet level ground at the height of the lab's. */
static void expected(double range_m[2], const View *view, int row)
{
    range_m[0] = INFINITY, range_m[1] = 0;
    for (int x = 0; x < view->width; x++) {
        double d_enu[3];
        view_ray(d_enu, view, x + 0.5, row + 0.5);
        const double one_m = view->p_enu[2] / -d_enu[2];
        range_m[0] = fmin(range_m[0], one_m);
        range_m[1] += one_m / view->width;
    }
}

static void look_at_gauge(const Frame *frame, const FrameOutput *out, int first_row)
{
    const GaugeRecord *record = out->record;
    const double       moved_m[3] = {0, 60 * gauge_ahead_s, 0};
    if (out->left_out) {
        CHECK(strcmp(out->left_out, "it rests") == 0 && !out->record && out->arrays == 0);
        return;
    }
    CHECK(out->arrays == 1 && strcmp(out->array->group, out->name) == 0 && out->array->size[0] == gauge_rows);
    const double(*got)[2] = out->array->values;
    for (int row = 0; row < gauge_rows; row++) {
        double want[2];
        expected(want, &frame->request.view, first_row + row);
        for (int k = 0; k < 2; k++) CHECK_NEAR(got[row][k], want[k], 0.01 * want[k]); /* half a pixel is 0.6 % */
    }
    for (int k = 0; k < 3; k++) { /* float32 speeds; the tangent plane leaves the Earth by less */
        CHECK_NEAR(record->eye_m[k], moved_m[k], 1e-3);
        CHECK_NEAR(record->entity_m[k], moved_m[k], 1e-3);
    }
    CHECK(record->looks == lab.shots); /* its own count of the session's frames */
    arrays_seen++;
}

static void look_at(void *user, const Frame *frame)
{
    (void)user;
    frames_with_truth += frame->request.truth;
    lab.shots++;
    CHECK(frame->output[0].kind == &camera_kind);
    if (!lab.kinds) {
        CHECK(frame->outputs == 1 && !frame_output(frame, &gauge_kind));
        return;
    }
    CHECK(frame->outputs == 3 && frame_output(frame, &gauge_kind) == &frame->output[1]);
    CHECK(strcmp(frame->output[1].name, "upper") == 0 && strcmp(frame->output[2].name, "lower") == 0);
    look_at_gauge(frame, &frame->output[1], 0);
    look_at_gauge(frame, &frame->output[2], gauge_rows);
}

/* An aircraft 300 m up at 60 m/s to the north, that looks ahead and down; no consumer wants truth. */
static void fly(void)
{
    static const DisEntityType plane = {1, 2, 225, 1, 1, 1, 0};
    Config                     config = config_default();
    lab_forget();
    for (int k = 0; k <= 4; k++) {
        LabReport r = {
            .t_s = 100 + k, .entity = 1, .type = plane, .v_enu_mps = {0, 60, 0}, .p_enu = {0, 60 * k - 300, 300}};
        test_attitude(r.r_enu_from_body, 0, 0, 0);
        lab_say(&r);
    }
    strcpy(config.exercise.host, "1:1:1");
    config.sensor.gimbal_limit_deg = 0;
    config.sensor.mount_pitch_deg = -45;
    config.sensor.hfov_deg = 8;
    config.publish.truth = false;
    lab.look = look_at;
    frames_with_truth = arrays_seen = gauges_closed = 0;
    lab_run(&config, 1, 8, gauge_frames);
    CHECK(lab.shots == gauge_frames);
}

static void two_of_a_kind_look_along_one_eye(void **state)
{
    (void)state;
    lab.kinds = with_gauges;
    fly();
    CHECK(frames_with_truth == gauge_frames); /* for their sake */
    CHECK(arrays_seen == gauge_frames / 2 + gauge_frames && gauges_closed == 2);
    const InstrumentCount *count = lab.result.instrument;
    CHECK(count[0].kind == &camera_kind && count[0].left_out == 0 && !count[0].why);
    CHECK(strcmp(count[1].name, "upper") == 0 && count[1].left_out == gauge_frames / 2);
    CHECK(strcmp(count[1].why, "it rests") == 0 && count[2].left_out == 0);
    CHECK(instruments_left_out(count, &gauge_kind) == gauge_frames / 2);
}

static void without_them_nothing_of_theirs_is_made(void **state)
{
    (void)state;
    lab.kinds = NULL;
    fly();
    CHECK(frames_with_truth == 0 && arrays_seen == 0 && gauges_closed == 0);
    CHECK(instruments_left_out(lab.result.instrument, &gauge_kind) == 0);
}

static void one_too_many_is_refused_and_closed(void **state)
{
    (void)state;
    Instruments list = {0};
    gauges_closed = 0;
    for (int i = 0; i < instruments_most; i++) assert_int_equal(gauge_add(&list, "gauge", 0, false), STATUS_OK);
    assert_int_equal(gauge_add(&list, "gauge", 0, false), STATUS_BAD_VALUE);
    CHECK(gauges_closed == 1 && list.count == instruments_most && instruments_find(&list, &gauge_kind));
    instruments_close(&list);
    CHECK(gauges_closed == 1 + instruments_most && !instruments_find(&list, &gauge_kind));
}

static void adding_shows_this_one(void **state)
{
    (void)state;
    check_adding_snippet("instrument", "tests/sensor/test_instruments.c");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_of_a_kind_look_along_one_eye),
        cmocka_unit_test(without_them_nothing_of_theirs_is_made),
        cmocka_unit_test(one_too_many_is_refused_and_closed),
        cmocka_unit_test(adding_shows_this_one),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
