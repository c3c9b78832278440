/* sensor/truth/truth.c: truth of the targets in a frame. */
#include "sensor/truth/truth.h"

/* Rate at which the Earth turns, rad/s. Source: IERS Conventions 2010, table 1.2 (nominal mean angular velocity). */
static const double earth_rate_rps = 7.292115e-5;

/* ---- geometry ------------------------------------------------------------------------------- */

static void line_of_sight(Target *t, const SnapshotEntity *entity, const Model *model, const EyeState *eye)
{
    double centre_body[3] = {0, 0, -0.5 * model->height_m}, lever_ecef[3], p_ecef[3], r_ecef[3], u_ecef[3];
    m3_mul_v3(lever_ecef, entity->r_ecef_from_body, centre_body);
    v3_add(p_ecef, entity->p_ecef, lever_ecef);
    v3_sub(r_ecef, p_ecef, eye->p_ecef);
    t->range_m = v3_length(r_ecef);
    if (!v3_normalize(u_ecef, r_ecef)) return;

    /* the velocity of the centre is that of the origin plus that by the rotation of the body */
    double turn_body[3], turn_ecef[3], v_ecef[3];
    v3_cross(turn_body, entity->w_body_rps, centre_body);
    m3_mul_v3(turn_ecef, entity->r_ecef_from_body, turn_body);
    v3_add(v_ecef, entity->v_ecef_mps, turn_ecef);
    v3_sub(v_ecef, v_ecef, eye->v_ecef_mps);
    t->closing_mps = -v3_dot(v_ecef, u_ecef);

    /* inertial: the rotating frame adds Earth's rate x the relative position */
    v_ecef[0] -= earth_rate_rps * r_ecef[1];
    v_ecef[1] += earth_rate_rps * r_ecef[0];
    double rate_ecef[3], rate_cam[3], u_cam[3];
    for (int k = 0; k < 3; k++) rate_ecef[k] = (v_ecef[k] - v3_dot(v_ecef, u_ecef) * u_ecef[k]) / t->range_m;
    m3_tmul_v3(rate_cam, eye->r_ecef_from_cam, rate_ecef);
    m3_tmul_v3(u_cam, eye->r_ecef_from_cam, u_ecef);
    t->los_rate_rps[0] = rate_cam[0];
    t->los_rate_rps[1] = -rate_cam[1];
    t->boresight_error_rad[0] = atan2(u_cam[0], u_cam[2]);
    t->boresight_error_rad[1] = atan2(-u_cam[1], u_cam[2]);

    Geodetic place;
    double   origin_ecef[3], r_ecef_from_enu[9], u_enu[3];
    if (geodetic_from_ecef(&place, eye->p_ecef) == STATUS_OK &&
        ecef_from_geodetic(origin_ecef, r_ecef_from_enu, &place) == STATUS_OK) {
        m3_tmul_v3(u_enu, r_ecef_from_enu, u_ecef);
        t->los_az_rad = atan2(u_enu[0], u_enu[1]);
        t->los_el_rad = asin(clamp(u_enu[2], -1, 1));
        t->depression_rad = -t->los_el_rad;
        if (t->los_az_rad < 0) t->los_az_rad += 2 * pi_rad;
    }
    /* nose-on 0: direction of the sensor as seen from the target, clockwise from above = towards its right */
    double back_body[3], back_ecef[3];
    v3_scale(back_ecef, -1, u_ecef);
    m3_tmul_v3(back_body, entity->r_ecef_from_body, back_ecef);
    t->aspect_rad = atan2(back_body[1], back_body[0]);
    if (t->aspect_rad < 0) t->aspect_rad += 2 * pi_rad;
}

/* ---- radiometry ----------------------------------------------------------------------------- */

typedef struct Moments {
    double n, sum, sum_2;
} Moments;

static void moments_add(Moments *m, double x)
{
    m->n++;
    m->sum += x;
    m->sum_2 += x * x;
}

static double moments_mean(const Moments *m) { return m->sum / m->n; }
static double moments_variance(const Moments *m)
{
    const double mean = moments_mean(m);
    return fmax(0, m->sum_2 / m->n - mean * mean);
}

/* Box around the target that holds at least as many other pixels as the target has, grown evenly; clipped. */
static void ring_box(int ring[4], const Target *t, const Picture *picture)
{
    const double pixels = fmax(t->pixels, 1);
    for (int grow = 1;; grow++) {
        ring[0] = t->box[0] - grow > 0 ? t->box[0] - grow : 0;
        ring[1] = t->box[1] - grow > 0 ? t->box[1] - grow : 0;
        ring[2] = t->box[2] + grow < picture->width ? t->box[2] + grow : picture->width;
        ring[3] = t->box[3] + grow < picture->height ? t->box[3] + grow : picture->height;
        const double area = (double)(ring[2] - ring[0]) * (ring[3] - ring[1]);
        const bool   whole = ring[0] == 0 && ring[1] == 0 && ring[2] == picture->width && ring[3] == picture->height;
        if (area >= 2 * pixels || whole) return;
    }
}

enum { run_px = 256 };

/* Gives the values to compare, of at most run_px adjacent pixels from px on. */
typedef void PixelValues(double *value, const void *user, size_t px, int count);

/* Ring: pixels in the box that show neither this target nor another, nor part of a small one. */

static void two_moments(Moments *target, Moments *ring, const Target *t, const Picture *picture, PixelValues *values,
                        const void *user)
{
    int     box[4];
    double  value[run_px];
    Moments on = {0, 0, 0}, about = {0, 0, 0};
    ring_box(box, t, picture);
    for (int y = box[1]; y < box[3]; y++)
        for (int x = box[0]; x < box[2]; x += run_px) {
            const size_t    first = (size_t)y * (size_t)picture->width + (size_t)x;
            const int       count = box[2] - x < run_px ? box[2] - x : run_px;
            const uint32_t *entity = picture->entity + first;
            const float    *covered = picture->covered ? picture->covered + first : NULL;
            values(value, user, first, count);
            for (int i = 0; i < count; i++) {
                if (entity[i] == (uint32_t)t->index + 1) moments_add(&on, value[i]);
                else if (entity[i] == 0 && !(covered && covered[i] > 0)) moments_add(&about, value[i]);
            }
        }
    *target = on;
    *ring = about;
}

typedef struct ThermalPlane {
    const float       *plane;
    const PlanckTable *planck;
} ThermalPlane;

static void apparent_temp(double *temp_k, const void *user, size_t px, int count)
{
    const ThermalPlane *p = user;
    planck_table_temps(temp_k, p->planck, p->plane + px, count);
}

static void plain_value(double *value, const void *user, size_t px, int count)
{
    const float *plane = (const float *)user + px;
    for (int i = 0; i < count; i++) value[i] = plane[i];
}

static void luminance(double *value, const void *user, size_t px, int count)
{
    const Picture *p = user;
    if (!p->optical[1]) {
        plain_value(value, p->optical[0], px, count);
        return;
    }
    const float *r = p->optical[0] + px, *g = p->optical[1] + px, *b = p->optical[2] + px;
    for (int i = 0; i < count; i++) value[i] = (r[i] + g[i] + b[i]) / 3.0;
}

/* Turns a radiance of the target's own into an intensity: times the area it fills, of whole pixels or parts of them. */
static double per_intensity(const Target *t, const View *view)
{
    return 1 / (view->focal_px * view->focal_px) * t->range_m * t->range_m;
}

/* The contribution of sampling; channels are sampled together, so that their errors add up. */
static void intensity_error(Target *t, const TargetPixels *px, const Picture *picture, const View *view)
{
    static const int first[BAND_RADAR + 1] = {picture_optical, picture_mwir, picture_lwir, picture_radar};
    if (!picture->budget || !px->small) return;
    for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++) {
        double sum = 0;
        for (int k = first[b]; k < first[b + 1]; k++)
            if (picture_plane(picture, k)) sum += px->radiance_error[k];
        if (isfinite(t->band[b].intensity_w_sr)) t->band[b].intensity_error_w_sr = sum * per_intensity(t, view);
    }
}

static double intensity(const Target *t, const TargetPixels *px, const View *view, int plane)
{
    return px->radiance[plane] / (view->focal_px * view->focal_px) * t->range_m * t->range_m;
}

/* Values of a band on a target and around it. A small target's pixels are part ground, and it may have no full
 * pixel: mean and variance are those of its own samples, filled in by the caller. */
typedef struct Look {
    double mean, variance;
    double ring_mean, ring_variance;
    bool   alone; /* there is no ring: both are 0 */
} Look;

static bool look_at(Look *look, const Target *t, const TargetPixels *px, const Picture *picture, PixelValues *values,
                    const void *user)
{
    Moments target, ring;
    two_moments(&target, &ring, t, picture, values, user);
    if (!(px->small || target.n > 0)) return false;
    *look = (Look){.alone = !(ring.n > 0)};
    if (!look->alone) look->ring_mean = moments_mean(&ring), look->ring_variance = moments_variance(&ring);
    if (px->small) return true;
    look->mean = moments_mean(&target);
    look->variance = moments_variance(&target);
    return true;
}

/* The contrast of a small target over noise is that of its fullest pixel, which is proportional to the target's share
 * of that pixel. */
static double to_noise(const Look *look, const TargetPixels *px, double noise_sigma)
{
    const double sigma = sqrt(look->ring_variance + noise_sigma * noise_sigma), apart = look->mean - look->ring_mean;
    return sigma > 0 ? apart * (px->small ? px->peak_area : 1) / sigma : apart == 0 ? 0 : NAN;
}

static void thermal_band(TargetBand *out, const Target *t, const TargetPixels *px, const Picture *picture, int plane,
                         const PlanckTable *planck, double netd_k)
{
    const ThermalPlane user = {picture_plane(picture, plane), planck};
    Look               look = {0};
    if (!look_at(&look, t, px, picture, apparent_temp, &user) || look.alone) return;
    if (px->small) {
        /* temperature is nearly linear in radiance over a target: the slope at its mean is used */
        const double mean = px->mean[plane], step = 1e-3 * mean;
        look.mean = planck_table_temp(planck, mean);
        const double slope = step > 0 ? (planck_table_temp(planck, mean + step) - look.mean) / step : 0;
        look.variance = slope * slope * px->variance[plane];
    }
    out->contrast_k = look.mean - look.ring_mean;
    out->dt_rss_k = sqrt(out->contrast_k * out->contrast_k + look.variance);
    out->snr = to_noise(&look, px, netd_k);
}

/* The value of a pixel is the mean of so many planes, from `plane` on. */
typedef struct PlainPlanes {
    PixelValues *values;
    const void  *user; /* of values */
    int          plane, count;
} PlainPlanes;

static void plain_band(TargetBand *out, const Target *t, const TargetPixels *px, const Picture *picture,
                       const PlainPlanes *of, double noise_sigma)
{
    Look look = {0};
    if (!look_at(&look, t, px, picture, of->values, of->user)) return;
    if (px->small) {
        look.mean = 0;
        for (int k = 0; k < of->count; k++) look.mean += px->mean[of->plane + k] / of->count;
    }
    if (look.ring_mean > 0) out->contrast = (look.mean - look.ring_mean) / look.ring_mean;
    if (!look.alone || noise_sigma > 0) out->snr = to_noise(&look, px, noise_sigma);
}

/* What an observer makes of its visible pixels. The bars of the MRTD stand for a target's mean, TTP for its mean and
 * variance together. */
static void observe(TargetBand *out, double pixels, const TruthNoise *noise, int band)
{
    const Acquisition *of = noise->observed[band];
    if (!of) return;
    const bool   emits = band != BAND_OPTICAL;
    const double size_px = sqrt(pixels), mean = emits ? out->contrast_k : out->contrast;
    out->cycles = size_px * acquisition_cycles_px(of, &noise->bars[band], mean);
    out->ttp_v = size_px * acquisition_ttp_px(of, &noise->bars[band], emits ? out->dt_rss_k : mean);
    for (int k = 0; k < acquisition_tasks; k++) out->p[k] = ttp_probability(out->ttp_v / ttp_criteria.at50[k]);
}

static void radiometry(Target *t, const TargetPixels *px, const Picture *picture, const World *world,
                       const RenderRequest *request, const TruthNoise *noise)
{
    const View *view = &request->view;
    if (!(px->visible > 0)) return;
    if (picture->optical[0]) {
        const int channels = picture->optical[1] ? 3 : 1;
        /* the noise of the mean of three channels is lower by a factor of sqrt(3) */
        plain_band(&t->band[BAND_OPTICAL], t, px, picture,
                   &(PlainPlanes){luminance, picture, picture_optical, channels},
                   noise->optical_w_m2_sr / sqrt(channels));
        t->band[BAND_OPTICAL].intensity_w_sr = 0; /* the channels together: 0.4-0.7 um */
        for (int k = 0; k < channels; k++)
            t->band[BAND_OPTICAL].intensity_w_sr += intensity(t, px, view, picture_optical + k);
    }
    if (picture->mwir) {
        thermal_band(&t->band[BAND_MWIR], t, px, picture, picture_mwir, world->planck_mwir, noise->netd_mwir_k);
        t->band[BAND_MWIR].intensity_w_sr = intensity(t, px, view, picture_mwir);
    }
    if (picture->lwir) {
        thermal_band(&t->band[BAND_LWIR], t, px, picture, picture_lwir, world->planck_lwir, noise->netd_lwir_k);
        t->band[BAND_LWIR].intensity_w_sr = intensity(t, px, view, picture_lwir);
    }
    intensity_error(t, px, picture, view);
    for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++) observe(&t->band[b], px->visible, noise, b);
    if (picture->radar)
        plain_band(&t->band[BAND_RADAR], t, px, picture, &(PlainPlanes){plain_value, picture->radar, picture_radar, 1},
                   0);
}

/* The wheels of an entity on the ground are partly below it: a hidden share below truth_occluded_least is no
 * occlusion, and all of the target counts as visible; otherwise the largest occluder is named, and the fraction is
 * below 1. */
static void visibility_of(Target *t, const TargetPixels *px, bool plants)
{
    const double ground = px->occluded_ground, entity = px->occluded_entity, trees = px->occluded_plants;
    const double scenery = px->occluded_scenery, hidden = ground + entity + trees + scenery;
    if (!(px->amodal > 0)) return;
    t->visible_fraction = 1;
    if (plants) t->foliage_fraction = clamp(trees / px->amodal, 0, 1);
    if (!(hidden >= truth_occluded_least * px->amodal)) return;
    t->visible_fraction = clamp(px->visible / px->amodal, 0, 1);
    t->occluder = scenery > trees && scenery > ground && scenery > entity ? "scenery"
                  : trees > ground && trees > entity                      ? "trees"
                  : ground >= entity                                      ? "ground"
                                                                          : "entity";
    if (*t->occluder == 'e') t->occluder_index = px->occluder;
}

int truth_targets(Target *out, const Picture *picture, const World *world, const Snapshot *snapshot,
                  const RenderRequest *request, const EyeState *eye, const TruthNoise *noise)
{
    static const TargetBand unknown = {.contrast_k = NAN,
                                       .dt_rss_k = NAN,
                                       .contrast = NAN,
                                       .snr = NAN,
                                       .intensity_w_sr = NAN,
                                       .intensity_error_w_sr = NAN,
                                       .veil_transmittance = NAN,
                                       .cycles = NAN,
                                       .ttp_v = NAN,
                                       .p = {NAN, NAN, NAN},
                                       .error_rms_k = NAN,
                                       .error_median_k = NAN};
    int                     count = 0;
    for (int i = 0; i < snapshot->count; i++) {
        const TargetPixels *px = &picture->target[i];
        if (i == eye->host_index || !(px->projected || px->amodal > 0)) continue;
        Target t = {
            .index = i, .pixels = px->visible, .visible_fraction = NAN, .foliage_fraction = NAN, .occluder_index = -1};
        t.error_px = t.range_m = t.closing_mps = t.aspect_rad = t.depression_rad = t.los_az_rad = t.los_el_rad = NAN;
        for (int b = 0; b < BAND_COUNT; b++) t.band[b] = unknown;
        for (int b = BAND_OPTICAL; b <= BAND_LWIR && px->visible > 0; b++)
            if (request->bands >> b & 1) t.band[b].veil_transmittance = 1 - px->veiled[b];
        line_of_sight(&t, &snapshot->entity[i], catalog_model(world->catalog, snapshot->entity[i].model), eye);
        visibility_of(&t, px, world->forest != NULL);
        memcpy(t.box, px->box, sizeof t.box);
        for (int k = 0; k < 4; k++) t.amodal_box[k] = px->projected ? px->projected_box[k] : px->amodal_box[k];
        radiometry(&t, px, picture, world, request, noise);
        out[count++] = t;
    }
    return count;
}
