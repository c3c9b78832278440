/* tests/bench/sensor/precision_small.c: the apparent position of a target of less than a pixel behind a detector's
 * optics. */
#include "tests/bench/sensor/precision.h"

#include "render/materials/planck.h"
#include "sensor/detector/blur_private.h"
#include "sensor/detector/subpixel_private.h"

enum { size_px = 32, most_places = 16, half_px = 7 };

static const double target_px = 0.44, still[2] = {0, 0};

typedef struct SmallWay {
    bool               cells, sums; /* by cells and nodes; or by sums over frequencies */
    Blur              *blur;
    SubPixel          *sub;
    const PhotonTable *photons;
    const MtfChain    *chain;
    float              hot, ground;
    double             at[2]; /* of the target's centre, px */
    float              out[size_px * size_px];
} SmallWay;

/* Columns of the ideal image at x from the target, rows summed: frequencies of the row (f, 0). */
static double ideal_column(const MtfChain *chain, double x)
{
    enum { period_px = 128 };
    double sum = 1;
    for (int k = 1; k < chain->cutoff_cyc_px * period_px; k++) {
        const double f = (double)k / period_px;
        sum += 2 * mtf_optics(chain, f, 0) * mtf_jitter(chain, f, 0) * mtf_sinc(chain->footprint_px * f) *
               mtf_sinc(target_px * f) * cos(2 * pi_rad * f * x);
    }
    return sum / period_px;
}

static double ideal_centroid(const MtfChain *chain, double at_px)
{
    double sum = 0, moment = 0;
    for (int i = -half_px; i <= half_px; i++) {
        const double centre = size_px / 2 + i + 0.5, value = ideal_column(chain, centre - at_px);
        sum += value;
        moment += value * centre;
    }
    return moment / sum;
}

static void look(void *user)
{
    static double more[size_px * size_px];
    SmallWay     *w = user;
    SmallTarget   t = {.columns = 1, .rows = 1};
    bool          met = true;
    float         plane[size_px * size_px], behind[4];
    double        area[4];
    if (w->sums) {
        bench_keep(&(double){ideal_centroid(w->chain, w->at[0]) + ideal_centroid(w->chain, w->at[1])});
        return;
    }
    for (int k = 0; k < 2; k++) t.box_px[k] = w->at[k] - 0.5 * target_px, t.box_px[k + 2] = w->at[k] + 0.5 * target_px;
    t.x0 = (int)floor(t.box_px[0]), t.x1 = (int)ceil(t.box_px[2]);
    t.y0 = (int)floor(t.box_px[1]), t.y1 = (int)ceil(t.box_px[3]);
    t.met = &met, t.area = area, t.behind[picture_lwir] = behind, t.cell[picture_lwir] = &w->hot;
    for (int i = 0; i < size_px * size_px; i++) plane[i] = (float)photon_table_electrons(w->photons, (double)w->ground);
    for (int y = t.y0, k = 0; y < t.y1; y++)
        for (int x = t.x0; x < t.x1; x++, k++) {
            area[k] =
                (fmin(x + 1, t.box_px[2]) - fmax(x, t.box_px[0])) * (fmin(y + 1, t.box_px[3]) - fmax(y, t.box_px[1]));
            behind[k] = w->ground;
            const double radiance = (double)w->ground + area[k] * (double)(w->hot - w->ground);
            plane[y * size_px + x] = (float)photon_table_electrons(w->photons, radiance);
        }
    const SmallTargets  targets = {1, &t};
    const SubPixelPlane fine = {.electrons = plane,
                                .more = more,
                                .width = size_px,
                                .height = size_px,
                                .plane = picture_lwir,
                                .photons = w->photons,
                                .exposure = 1};
    if (w->cells) subpixel_targets(w->sub, &fine, &targets, still);
    blur_apply_with(w->blur, w->out, plane, still, w->cells ? more : NULL);
    bench_keep(w->out);
}

/* Distance between the centroid's error and the ideal's along rows, rms over positions within a pixel. */
static double centroid_error(SmallWay *w)
{
    double square = 0;
    for (int k = 0; k < most_places && !w->sums; k++) {
        double sum = 0, moment = 0;
        w->at[0] = size_px / 2 + (k + 0.5) / most_places;
        w->at[1] = size_px / 2 + fmod((k + 0.5) * 0.6180339887498949, 1);
        look(w);
        const double ground_e = photon_table_electrons(w->photons, (double)w->ground);
        for (int y = 0; y < size_px; y++)
            for (int x = size_px / 2 - half_px; x <= size_px / 2 + half_px; x++) {
                const double e = (double)w->out[y * size_px + x] - ground_e;
                sum += e;
                moment += e * (x + 0.5);
            }
        const double off = moment / sum - ideal_centroid(w->chain, w->at[0]);
        square += off * off / most_places;
    }
    return sqrt(square);
}

Status precision_small_target(Bench *bench)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"whole pixels", "nodes of 1/8 px", "sums over frequencies"};
    static SmallWay          way[settings];
    const PhotonDetector     d = {.low_m = 8e-6,
                                  .high_m = 12e-6,
                                  .f_number = 2,
                                  .transmission = 0.8,
                                  .qe = 0.7,
                                  .pitch_m = 25e-6,
                                  .integration_s = 1e-4};
    const MtfChain chain = {.cutoff_cyc_px = 25e-6 / (10e-6 * 2), .footprint_px = 0.95, .places = 16, .jitter_px = 0.1};
    BenchWork      work[settings];
    BenchSetting   point[settings] = {0};
    PhotonTable   *photons = NULL;
    Blur          *blur = NULL;
    SubPixel      *sub = NULL;
    Status         status = photon_table_create(&photons, &d, true);
    if (status == STATUS_OK) status = blur_create(&blur, size_px, size_px, &chain);
    if (status == STATUS_OK) status = subpixel_create(&sub, &chain);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        way[k] = (SmallWay){.cells = k == 1,
                            .sums = k == 2,
                            .blur = blur,
                            .sub = sub,
                            .photons = photons,
                            .chain = &chain,
                            .hot = (float)planck_band(d.low_m, d.high_m, 400, NULL),
                            .ground = (float)planck_band(d.low_m, d.high_m, 280, NULL),
                            .at = {size_px / 2 + 0.3, size_px / 2 + 0.8}};
        work[k] = (BenchWork){look, &way[k], 1};
        point[k] = (BenchSetting){.setting = name[k], .error = centroid_error(&way[k]), .is_default = k == 1};
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"a small target's place", "sensor/detector/subpixel.c",
                                      "a picture of 32 x 32 with a target of 0.44 px", "px",
                                      "centroid of counts, rms over places, of an ideal sampled sensor's", 0.0015},
                      work, point, settings);
    subpixel_destroy(sub);
    blur_destroy(blur);
    photon_table_destroy(photons);
    return status;
}
