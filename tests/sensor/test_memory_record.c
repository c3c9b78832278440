/* A frame's record and its targets in shared memory, each value of its own, read by the public header: no field has
 * that of another. */
#include "tests/check.h"

#include "sensor/publish/memory/consume_memory.h"

#include <pitviper_memory.h>

enum { width = 4, height = 2 };
static const float plane[height * width] = {1, 2, 3, 4, 5, 6, 7, 8};

/* Values that differ: from, from + 1 ... */
static void count_up(double *out, int count, double from)
{
    for (int i = 0; i < count; i++) out[i] = from + i;
}

static TargetRecord target_of(int n)
{
    TargetRecord t = {.id = {10, 11, 12},
                      .marking = "Ares",
                      .type = {1, 1, 222, 1, 2, 3, 4},
                      .class_number = target_class((DisEntityType){1, 1, 222, 1, 2, 3, 4}),
                      .plane_value = 14,
                      .box = {21, 22, 23, 24},
                      .pixels = 31,
                      .visible_fraction = 0.32,
                      .foliage_fraction = 0.33,
                      .range_m = 34,
                      .closing_mps = 35,
                      .aspect_rad = 0.36,
                      .depression_rad = 0.37,
                      .los_az_rad = 0.38,
                      .los_el_rad = 0.39,
                      .occluder = OCCLUDER_ENTITY,
                      .age_s = 40,
                      .position_error_m = 41,
                      .error_px = 42};
    if (n > 0) t.id.entity = (uint16_t)(12 + n);
    count_up(t.amodal_box, 4, 50), count_up(t.los_rate_rps, 2, 54), count_up(t.boresight_error_rad, 2, 56);
    count_up(t.p_ecef, 3, 60), count_up(t.v_ecef_mps, 3, 63);
    for (int b = 0; b < BAND_COUNT; b++) {
        double v[7];
        count_up(v, 7, 100 + 10 * b);
        t.band[b] = (TargetBand){.contrast_k = v[0],
                                 .dt_rss_k = v[1],
                                 .contrast = v[2],
                                 .snr = v[3],
                                 .intensity_w_sr = v[4],
                                 .veil_transmittance = v[5],
                                 .intensity_error_w_sr = v[6]};
    }
    return t;
}

static void fill(Frame *f, TargetRecord target[2], FrameArray *radiance)
{
    target[0] = target_of(0), target[1] = target_of(1);
    *radiance =
        (FrameArray){.kind = PLANE_RADIANCE, .type = PLANE_F32, .size = {height, width}, .axes = 2, .values = plane};
    f->number = 7, f->time_s = 8.5, f->unix_s = 1e9 + 0.25;
    snprintf(f->host, sizeof f->host, "1:2:3");
    f->seen.plane[0] = *radiance, f->seen.plane_count = 1;
    f->buried = true;
    f->request.view = (View){.width = width, .height = height, .focal_px = 9};
    f->request.view.lens = (Lens){.k = {0.1, 0.2, 0.3}, .p = {0.4, 0.5}, .reach = 1};
    f->times = (LatencyTimes){.arrived_s = 201, .posed_s = 203};
    f->provenance = (Provenance){
        .config_sha256 = "ab12", .seed = -5, .datagrams = 77, .begun_s = 202, .posed_s = 299, .rendered_s = 204};
    FrameRecord *r = &f->record;
    r->hfov_rad = 0.7, r->gimbal_at_limit = true, r->target = target, r->target_count = 2;
    count_up(r->p_eye_ecef, 3, 1000), count_up(r->v_eye_mps, 3, 1010), count_up(r->scene_rate_px_s, 2, 1020);
    count_up(r->r_ecef_from_cam, 9, 1030), count_up(r->r_ecef_from_body, 9, 1050);
}

static void check_values(const double *got, int count, double from)
{
    for (int i = 0; i < count; i++) CHECK_NEAR(got[i], from + i, 0);
}

static void every_value_in_its_place(void **state)
{
    (void)state;
    Frame         *frame = calloc(1, sizeof *frame);
    Config         config = config_default();
    TargetRecord   target[2];
    FrameArray     radiance;
    Consumer      *consumer;
    PitviperMemory m;
    CHECK(frame);
    fill(frame, target, &radiance);
    snprintf(config.publish.memory, sizeof config.publish.memory, "pitviper_record_%d", (int)getpid());
    config.publish.memory_record = MEMORY_RECORD_TRUTH;
    config.sensor.width_px = width, config.sensor.height_px = height;
    const MemoryOf of = {.config = &config, .config_sha256 = "ab12", .bands = 1u << BAND_LWIR};
    CHECK(consume_memory(&consumer, &of) == STATUS_OK);
    CHECK(!consumer->begin || consumer->begin(consumer) == STATUS_OK);
    CHECK(pitviper_memory_open(&m, config.publish.memory) == 0);
    CHECK(consumer->put(consumer, frame) == STATUS_OK && pitviper_memory_take_next(&m) == 1);

    const PitviperMemoryRecord *r = &m.record;
    CHECK(r->frame == 7 && r->flags == 3 && r->time_s == 8.5 && r->unix_us == 1000000000250000);
    check_values(r->p_ecef, 3, 1000), check_values(r->v_ecef, 3, 1010), check_values(r->scene_rate_px_s, 2, 1020);
    check_values(r->r_ecef_from_cam, 9, 1030), check_values(r->r_ecef_from_body, 9, 1050);
    for (int k = 0; k < 3; k++) CHECK(r->boresight_ecef[k] == 1032 + 3 * k); /* third column */
    CHECK(r->hfov_rad == 0.7 && r->focal_px == 9);
    CHECK_NEAR(r->vfov_rad, 2 * atan(1.0 / 9), 1e-15); /* half of two rows over the focal length */
    /* OpenCV's order: k1, k2, p1, p2, k3 */
    static const double opencv[5] = {0.1, 0.2, 0.4, 0.5, 0.3};
    CHECK(memcmp(r->distortion, opencv, sizeof opencv) == 0);
    CHECK(r->arrived_ns == 201000000000 && r->begun_ns == 202000000000 && r->posed_ns == 203000000000 &&
          r->rendered_ns == 204000000000 && r->written_ns > 0);
    CHECK(r->seed == -5 && r->datagrams == 77 && r->target_count == 2 && r->targets_left_out == 0);
    CHECK(strcmp(r->host, "1:2:3") == 0 && strcmp(r->config_sha256, "ab12") == 0);
    CHECK(memcmp(pitviper_memory_plane(&m, 0), plane, sizeof plane) == 0);

    PitviperMemoryTarget t;
    CHECK(pitviper_memory_target(&t, &m, 1) && t.entity == 13 && pitviper_memory_target(&t, &m, 0));
    CHECK(t.site == 10 && t.application == 11 && t.entity == 12 &&
          t.class_number == target_class((DisEntityType){1, 1, 222, 1, 2, 3, 4}));
    CHECK(strcmp(t.class_name, "tank") == 0 && t.plane_value == 14 && t.flags == OCCLUDER_ENTITY);
    CHECK(strcmp(t.marking, "Ares") == 0 && strcmp(t.type, "1.1.222.1.2.3.4") == 0);
    for (int k = 0; k < 4; k++) CHECK(t.box[k] == 21 + k);
    check_values(t.amodal_box, 4, 50), check_values(t.los_rate_rps, 2, 54), check_values(t.boresight_error_rad, 2, 56);
    check_values(t.p_ecef, 3, 60), check_values(t.v_ecef, 3, 63);
    CHECK(t.pixels == 31 && t.visible_fraction == 0.32 && t.range_m == 34 && t.closing_mps == 35);
    CHECK(t.aspect_rad == 0.36 && t.depression_rad == 0.37 && t.los_az_rad == 0.38 && t.los_el_rad == 0.39);
    CHECK(t.age_s == 40 && t.position_error_m == 41);
    for (int b = 0; b < BAND_COUNT; b++) {
        const PitviperMemoryTargetBand *v = &t.band[b];
        const double                    got[6] = {v->contrast_k, v->dt_rss_k,       v->contrast,
                                                  v->snr,        v->intensity_w_sr, v->smoke_transmittance};
        check_values(got, 6, 100 + 10 * b);
    }
    pitviper_memory_close(&m);
    CHECK(consumer->close(consumer) == STATUS_OK);
    free(frame);
}

/* There is room for 256 targets: those that are seen first, then of the hidden ones the first; all in their order. */
static void targets_that_have_no_room(void **state)
{
    (void)state;
    static TargetRecord target[300];
    for (int seen = 0; seen <= 300; seen += 100) {
        Frame         *frame = calloc(1, sizeof *frame);
        Config         config = config_default();
        FrameArray     radiance;
        Consumer      *consumer;
        PitviperMemory m;
        CHECK(frame);
        fill(frame, target, &radiance);
        for (int i = 0; i < 300; i++) {
            target[i] = target_of(1 + i);
            target[i].pixels = i % 3 < seen / 100 ? 5 : 0;
        }
        frame->record.target_count = 300;
        snprintf(config.publish.memory, sizeof config.publish.memory, "pitviper_room_%d", (int)getpid());
        config.publish.memory_record = MEMORY_RECORD_TRUTH;
        config.sensor.width_px = width, config.sensor.height_px = height;
        const MemoryOf of = {.config = &config, .config_sha256 = "ab12", .bands = 1u << BAND_LWIR};
        CHECK(consume_memory(&consumer, &of) == STATUS_OK);
        CHECK(pitviper_memory_open(&m, config.publish.memory) == 0);
        CHECK(consumer->put(consumer, frame) == STATUS_OK && pitviper_memory_take_next(&m) == 1);
        CHECK(m.record.target_count == 256 && m.record.targets_left_out == 44);
        int next = 0, hidden = 0;
        for (uint32_t k = 0; k < 256; k++) {
            PitviperMemoryTarget t;
            while (target[next].pixels == 0 && hidden == 256 - seen) next++; /* no room for more of these */
            CHECK(pitviper_memory_target(&t, &m, k) && next < 300 && t.entity == 13 + next);
            hidden += target[next++].pixels == 0;
        }
        pitviper_memory_close(&m);
        CHECK(consumer->close(consumer) == STATUS_OK);
        free(frame);
    }
}

/* Raw counts of the bands with a sensor: three planes of colour and one of LWIR, each with its own values; a frame that
 * lacks one is refused. */
static void counts_of_each_plane(void **state)
{
    (void)state;
    static uint16_t counts[4][height * width];
    static float    none[height * width];
    Frame          *frame = calloc(1, sizeof *frame);
    Config          config = config_default();
    TargetRecord    target[2];
    FrameArray      radiance;
    Consumer       *consumer;
    PitviperMemory  m;
    CHECK(frame);
    fill(frame, target, &radiance);
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < width * height; i++) counts[c][i] = (uint16_t)(1000 * (c + 1) + i);
    for (int c = 0; c < 3; c++) frame->display[BAND_OPTICAL].counts[c] = counts[c];
    frame->display[BAND_OPTICAL].planes = 3;
    frame->display[BAND_OPTICAL].plane[0] = frame->display[BAND_LWIR].plane[0] = none;
    frame->display[BAND_LWIR].planes = 1, frame->display[BAND_LWIR].counts[0] = counts[3];
    snprintf(config.publish.memory, sizeof config.publish.memory, "pitviper_counts_%d", (int)getpid());
    config.publish.memory_planes = MEMORY_PLANES_COUNTS;
    config.publish.memory_record = MEMORY_RECORD_SENSOR;
    config.sensor.width_px = width, config.sensor.height_px = height;
    const MemoryOf of = {.config = &config,
                         .config_sha256 = "ab12",
                         .bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR,
                         .count_bits = {[BAND_OPTICAL] = 12, [BAND_LWIR] = 14}};
    CHECK(consume_memory(&consumer, &of) == STATUS_OK && consumer->wants == WANT_COUNTS);
    CHECK(pitviper_memory_open(&m, config.publish.memory) == 0 && m.header.plane_count == 4);
    CHECK(consumer->put(consumer, frame) == STATUS_OK && pitviper_memory_take_next(&m) == 1);
    for (uint32_t c = 0; c < 4; c++) {
        const uint16_t *got = pitviper_memory_plane(&m, c);
        const uint16_t  first = got[0];
        bool            whole = first % 1000 == 0 && first / 1000 >= 1 && first / 1000 <= 4;
        for (int i = 0; i < width * height; i++) whole &= got[i] == first + i;
        CHECK(whole && m.plane[c].bits == (c == 3 ? 14 : 12) && m.plane[c].type == PITVIPER_PLANE_UINT16);
        CHECK(first == 1000 * (c + 1));
    }
    CHECK(m.record.target_count == 0);
    log_set_sink(check_listen, NULL);
    frame->display[BAND_OPTICAL].planes = 2;
    CHECK(consumer->put(consumer, frame) == STATUS_BAD_VALUE && strstr(check_said, "frame 7"));
    frame->display[BAND_OPTICAL].planes = 3, frame->display[BAND_LWIR].counts[0] = NULL;
    CHECK(consumer->put(consumer, frame) == STATUS_BAD_VALUE);
    pitviper_memory_close(&m);
    CHECK(consumer->close(consumer) == STATUS_OK);
    CHECK(consume_memory(&consumer, &(MemoryOf){.config = &config, .config_sha256 = "", .bands = 1u << BAND_LWIR}) ==
          STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    free(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_value_in_its_place),
                                       cmocka_unit_test(targets_that_have_no_room),
                                       cmocka_unit_test(counts_of_each_plane)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
