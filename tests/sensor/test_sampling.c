/* Steps of sampling (RenderRequest.sampling) of one frame: pixels of and about the target are the same to the bit at
 * every step below the first; others have rays or are the mean of those beside them that have; a step has fewer rays
 * than the one before. */
#include "tests/sensor/eye_lab.h"

#include "sensor/node/session/frame_verdict.h"

enum { width = 24, height = 16, px = width * height, steps = SAMPLING_QUARTER + 1 };

static struct {
    float    lwir[px], range_m[px];
    uint32_t entity[px];
    uint64_t rays;
    double   visible;
    int      x0, y0, x1, y1; /* of the target's box */
} shot[steps];

static int step_now;

static unsigned choose_step(void *user, const FrameTime *frame)
{
    (void)user, (void)frame;
    return frame_verdict_of_sampling((Sampling)step_now);
}

static void look(void *user, const Frame *frame)
{
    (void)user;
    const Picture *p = &frame->seen.picture;
    CHECK(p->width == width && p->height == height && (int)frame->request.sampling == step_now);
    memcpy(shot[step_now].lwir, p->lwir, sizeof shot[0].lwir);
    memcpy(shot[step_now].range_m, p->range_m, sizeof shot[0].range_m);
    memcpy(shot[step_now].entity, p->entity, sizeof shot[0].entity);
    shot[step_now].rays = p->counters.rays_primary;
    CHECK(p->target && frame->seen.snapshot.count == 1);
    const TargetPixels *t = &p->target[0];
    shot[step_now].visible = t->visible;
    shot[step_now].x0 = (int)floor(t->projected_box[0]), shot[step_now].y0 = (int)floor(t->projected_box[1]);
    shot[step_now].x1 = (int)ceil(t->projected_box[2]), shot[step_now].y1 = (int)ceil(t->projected_box[3]);
}

static bool whole(int x, int y)
{
    return x >= shot[0].x0 - 4 && x < shot[0].x1 + 4 && y >= shot[0].y0 - 4 && y < shot[0].y1 + 4;
}

static bool has_rays(int step, int x, int y)
{
    if (x < 0 || y < 0 || x >= width || y >= height) return false;
    return whole(x, y) || (step == SAMPLING_CHECKERBOARD ? (x + y) % 2 == 0 : x % 2 == 0 && y % 2 == 0);
}

/* Mean of the neighbours that have rays, in the order of the sum. */
static float mean_about(int step, int x, int y)
{
    static const int beside[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}, {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    const int        corners = step == SAMPLING_QUARTER && x % 2 && y % 2;
    float            sum = 0;
    int              count = 0;
    for (int k = 0; k < 4; k++) {
        const int xb = x + beside[corners][k][0], yb = y + beside[corners][k][1];
        if (has_rays(step, xb, yb)) sum += shot[step].lwir[yb * width + xb], count++;
    }
    CHECK(count > 0);
    return sum / (float)count;
}

static void each_step(void **state)
{
    (void)state;
    Config config = config_default();
    strcpy(config.exercise.host, "observer");
    lab_forget();
    LabReport r = {.t_s = 100, .entity = 1, .type = {1, 1, 225, 1, 1, 1, 0}, .p_enu = {0, 0, 1}};
    test_attitude(r.r_enu_from_body, 0.5 * pi_rad, 0, 0);
    lab_say(&r);
    lab.adaptive = lab.live = true, lab.look = look, lab.choose = choose_step;
    for (step_now = 0; step_now < steps; step_now++) lab_run(&config, 0.5, 1, 1);
    lab.adaptive = lab.live = false, lab.look = NULL, lab.choose = NULL;

    int about = 0, others[steps] = {0}, seen = 0, apart[steps] = {0};
    for (int step = SAMPLING_TARGETS; step < steps; step++) {
        CHECK(shot[step].visible == shot[0].visible);
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const int k = y * width + x;
                seen += shot[step].entity[k] > 0;
                CHECK(shot[step].entity[k] == shot[0].entity[k]);
                if (whole(x, y) || step == SAMPLING_TARGETS) {
                    about++;
                    CHECK(shot[step].lwir[k] == shot[SAMPLING_TARGETS].lwir[k] &&
                          shot[step].range_m[k] == shot[0].range_m[k]);
                    if (shot[0].entity[k] > 0) CHECK(shot[step].lwir[k] == shot[0].lwir[k]);
                    continue;
                }
                others[step]++;
                if (has_rays(step, x, y)) {
                    CHECK(shot[step].range_m[k] == shot[0].range_m[k]);
                    continue;
                }
                apart[step] += shot[step].lwir[k] != shot[0].lwir[k];
                const bool inside = x >= 2 && y >= 2 && x < width - 2 && y < height - 2;
                /* within a checkerboard the mean is weighted: tests/sensor/test_sampling_steps.c */
                if (step != SAMPLING_CHECKERBOARD || !inside) CHECK(shot[step].lwir[k] == mean_about(step, x, y));
            }
    }
    CHECK(seen > 0 && about > px && others[SAMPLING_QUARTER] >= px / 4);
    /* most of them are not what rays of their own say: the twin of a step that gives nothing up */
    CHECK(apart[SAMPLING_CHECKERBOARD] > others[SAMPLING_CHECKERBOARD] / 3);
    CHECK(apart[SAMPLING_QUARTER] > others[SAMPLING_QUARTER] / 2);
    const uint64_t fewer = (uint64_t)others[SAMPLING_CHECKERBOARD] / 2;
    CHECK(shot[SAMPLING_TARGETS].rays == shot[SAMPLING_ALL].rays);
    CHECK(shot[SAMPLING_CHECKERBOARD].rays + fewer <= shot[SAMPLING_TARGETS].rays + 2);
    CHECK(shot[SAMPLING_QUARTER].rays + fewer * 3 / 2 <= shot[SAMPLING_TARGETS].rays + 12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_step)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
