/* Small targets through the optics of a detector: the plane that subpixel_targets and the blur make of cells at any
 * place within their pixels, against closed forms of what the optics, the footprint, jitter and smear make of
 * rectangles; what comes of it for centroids is test_centroid.c. labels: physics */
#include "tests/check.h"

#include "sensor/detector/subpixel_private.h"

enum { width = 56, height = 44, pixels = width * height, most_cells = 6, most_touched = 40 };

static float  electrons[pixels], shown[pixels];
static double more[pixels];

/* Up to two targets before an even background of radiance 1. */
typedef struct Cells {
    SmallTarget target;
    bool        met[most_cells];
    float       cell[most_cells], behind[most_touched];
    double      area[most_touched];
} Cells;

static void make(Cells *c, const double box_px[4], int columns, int rows, const float radiance[], unsigned met)
{
    *c = (Cells){.target = {.columns = columns, .rows = rows}};
    SmallTarget *t = &c->target;
    memcpy(t->box_px, box_px, sizeof t->box_px);
    t->x0 = (int)floor(box_px[0]), t->y0 = (int)floor(box_px[1]);
    t->x1 = (int)ceil(box_px[2]), t->y1 = (int)ceil(box_px[3]);
    for (int k = 0; k < columns * rows; k++) c->met[k] = met >> k & 1, c->cell[k] = radiance[k];
    const int touched = (t->x1 - t->x0) * (t->y1 - t->y0);
    CHECK(touched <= most_touched && columns * rows <= most_cells);
    for (int k = 0; k < touched; k++) c->behind[k] = 1, c->area[k] = 0.5;
    c->area[touched - 1] = 0;
    t->met = c->met, t->area = c->area;
    t->cell[picture_lwir] = c->cell, t->behind[picture_lwir] = c->behind;
}

/* Integral of the normal distribution's integral. */
static double twice(double u, double sigma)
{
    const double t = u / sigma;
    return u * 0.5 * erfc(-t / sqrt(2)) + sigma * exp(-0.5 * t * t) / sqrt(2 * pi_rad);
}

/* What a detector at x sees of a stripe of radiance 1 from `from` to `to`: the stripe blurred by jitter, averaged over
 * the footprint. */
static double stripe(double x, double from, double to, double footprint, double jitter)
{
    const double h = 0.5 * footprint;
    return (twice(x - from + h, jitter) - twice(x - from - h, jitter) - twice(x - to + h, jitter) +
            twice(x - to - h, jitter)) /
           footprint;
}

/* The plane of the targets, in electrons of radiance 1: what is seen of each cell less what it hides, averaged over the
 * way of the smear. */
static double sees(const Cells *c, int count, int column, int row, const MtfChain *chain, const double smear_px[2])
{
    const int steps = smear_px[0] == 0 && smear_px[1] == 0 ? 1 : 24;
    double    sum = 0;
    for (int s = 0; s < steps; s++) {
        const double way = (s + 0.5) / steps - 0.5, x = column + 0.5 - way * smear_px[0],
                     y = row + 0.5 - way * smear_px[1];
        for (int n = 0; n < count; n++) {
            const SmallTarget *t = &c[n].target;
            const double w = (t->box_px[2] - t->box_px[0]) / t->columns, h = (t->box_px[3] - t->box_px[1]) / t->rows;
            for (int k = 0; k < t->columns * t->rows; k++) {
                const double left = t->box_px[0] + w * (k % t->columns), top = t->box_px[1] + h * (k / t->columns);
                if (!c[n].met[k]) continue;
                sum += ((double)c[n].cell[k] - 1) * stripe(x, left, left + w, chain->footprint_px, chain->jitter_px) *
                       stripe(y, top, top + h, chain->footprint_px, chain->jitter_px);
            }
        }
    }
    return 1 + sum / steps;
}

typedef struct Detector {
    SubPixel    *sub;
    Blur        *blur;
    PhotonTable *photons;
    double       one_e; /* electrons of radiance 1, exposed */
} Detector;

static const double exposure = 0.5;

static void open_detector(Detector *d, const MtfChain *chain)
{
    const PhotonDetector photons = {.low_m = 8e-6,
                                    .high_m = 12e-6,
                                    .f_number = 2,
                                    .transmission = 1,
                                    .qe = 1,
                                    .pitch_m = 20e-6,
                                    .integration_s = 1e-4};
    CHECK(subpixel_create(&d->sub, chain) == STATUS_OK && blur_create(&d->blur, width, height, chain) == STATUS_OK);
    CHECK(photon_table_create(&d->photons, &photons, false) == STATUS_OK); /* the same electrons for every watt */
    d->one_e = exposure * photon_table_electrons(d->photons, 1);
}

static void close_detector(Detector *d)
{
    subpixel_destroy(d->sub);
    blur_destroy(d->blur);
    photon_table_destroy(d->photons);
}

/* Pixels that a target touches come with what a renderer mixed in them, 3, and are set anew; one in which it is said to
 * have no area keeps what it has. */
static void see(const Detector *d, Cells *c, int count, const double smear_px[2])
{
    SmallTarget         target[2];
    const SmallTargets  targets = {count, target};
    const SubPixelPlane p = {electrons, more, width, height, picture_lwir, d->photons, exposure};
    for (int i = 0; i < pixels; i++) electrons[i] = (float)d->one_e, more[i] = 1e9;
    for (int n = 0; n < count; n++) {
        target[n] = c[n].target;
        for (int y = target[n].y0, k = 0; y < target[n].y1; y++)
            for (int x = target[n].x0; x < target[n].x1; x++, k++)
                if (c[n].area[k] > 0) electrons[y * width + x] = 3 * (float)d->one_e;
    }
    subpixel_targets(d->sub, &p, &targets, smear_px);
    blur_apply_with(d->blur, shown, electrons, smear_px, more);
}

/* Without diffraction all is in closed form: cells of several radiances, brighter and darker than what they hide, some
 * of them without the target; one within a pixel, one across some; a smear along the rows, down, oblique and none, in
 * turn. 0.2 % of the largest difference: the tails of both point spreads beyond 8 pixels. */
static void cells_are_seen_where_they_are(void **state)
{
    (void)state;
    static const double smear_px[5][2] = {{0, 0}, {0.8, 0}, {0, 0.6}, {0.7, -0.4}, {0, 0}};
    static const float  radiance[most_cells] = {9, 4, 0, 6, 2, 12};
    double              worst = 0;
    for (int places = 1; places <= 4; places += 3) {
        const MtfChain chain = {.cutoff_cyc_px = INFINITY, .footprint_px = 0.9, .places = places, .jitter_px = 0.4};
        Detector       d;
        Cells          c[2];
        open_detector(&d, &chain);
        make(&c[0], (const double[4]){20.3, 18.7, 22.55, 19.4}, 3, 2, radiance, 0x37);
        make(&c[1], (const double[4]){30.62, 25.08, 30.81, 25.73}, 1, 1, (const float[1]){40}, 1);
        for (int s = 0; s < 5; s++) {
            double most = 0, off = 0;
            see(&d, c, 2, smear_px[s]);
            for (int row = 12; row < height - 12; row++)
                for (int column = 12; column < width - 12; column++) {
                    const double want = sees(c, 2, column, row, &chain, smear_px[s]);
                    most = fmax(most, fabs(want - 1));
                    off = fmax(off, fabs((double)shown[row * width + column] / d.one_e - want));
                }
            worst = fmax(worst, off / most);
        }
        close_detector(&d);
    }
    print_message("cells against closed forms: %.2e of the largest\n", worst);
    CHECK_NEAR(worst, 0, 2e-3);
}

/* Behind optics that pass nothing from 0.8 cycles a pixel on, sums of columns are those of the continuous picture,
 * whatever the place between the rows: the profile along the rows by its Fourier integral, aperture, footprint, jitter
 * and the cell's own width; and the other way. */
static void optics_blur_their_share(void **state)
{
    (void)state;
    const MtfChain chain = {
        .cutoff_cyc_px = 0.8, .obscuration = 0.3, .footprint_px = 0.9, .places = 2, .jitter_px = 0.2};
    static const double box_px[4] = {27.66, 21.07, 27.91, 21.42}, still[2] = {0, 0}, moved[2] = {0.5, -0.9};
    Detector            d;
    Cells               c;
    double              worst = 0;
    open_detector(&d, &chain);
    make(&c, box_px, 1, 1, (const float[1]){200}, 1);
    c.area[0] = 0.5;
    for (int smear = 0; smear < 2; smear++) {
        see(&d, &c, 1, smear ? moved : still);
        for (int axis = 0; axis < 2; axis++) {
            const double from = box_px[axis], to = box_px[2 + axis], size = to - from;
            double       most = 0, off = 0;
            for (int at = 10; at < (axis == 0 ? width : height) - 10; at++) {
                enum { steps = 400 };
                double want = 0, got = 0;
                for (int n = 0; n < steps; n++) {
                    const double f = 0.8 * (n + 0.5) / steps, jitter = exp(-2 * pow(pi_rad * 0.2 * f, 2));
                    want += 2 * 0.8 / steps * mtf_aperture(f / 0.8, 0.3) * mtf_sinc(0.9 * f) * jitter *
                            mtf_sinc(size * f) * mtf_sinc(smear ? moved[axis] * f : 0) *
                            cos(2 * pi_rad * f * (at + 0.5 - 0.5 * (from + to)));
                }
                want *= 199 * 0.25 * 0.35;
                for (int k = 0; k < (axis == 0 ? height : width); k++)
                    got += (double)shown[axis == 0 ? k * width + at : at * width + k] / d.one_e - 1;
                most = fmax(most, want);
                off = fmax(off, fabs(got - want));
            }
            worst = fmax(worst, off / most);
        }
    }
    print_message("sums behind optics: %.2e of the largest\n", worst);
    CHECK_NEAR(worst, 0, 2e-3);
    close_detector(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_seen_where_they_are),
        cmocka_unit_test(optics_blur_their_share),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
