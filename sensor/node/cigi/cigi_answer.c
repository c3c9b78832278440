/* sensor/node/cigi/cigi_answer.c: heights and lines of sight over the ground for a CIGI host, and what is answered
 * without them. */
#include "sensor/node/cigi/cigi_answer.h"

#include "render/trace/ground/ground.h"
#include "terrain/surface.h"

typedef struct Height {
    double   hat_m, hot_m, normal_enu[3]; /* normal in axes of the place */
    uint32_t material;
} Height;

/* Ground at the latitude and longitude of a place: where its vertical meets the surface, found by steps along it. Each
 * shortens the error by the angle between that vertical and the frame's times the slope: below 1 mm after `steps`. */
static bool height_at(Height *out, const CigiGround *ground, const double p_ecef[3])
{
    enum { steps = 8 };
    Geodetic place;
    double   at_ecef[3], at_enu[3], r_ecef_from_enu[9], normal_frame[3], normal_ecef[3];
    if (!ground->landscape || geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return false;
    const double height_m = place.h_m;
    for (int i = 0; i < steps; i++) {
        if (ecef_from_geodetic(at_ecef, r_ecef_from_enu, &place) != STATUS_OK) return false;
        enu_from_ecef(at_enu, ground->frame, at_ecef);
        const double z_m = elevation_height(&ground->landscape->elevation, at_enu[0], at_enu[1], normal_frame);
        if (!isfinite(z_m)) return false;
        place.h_m += z_m - at_enu[2];
    }
    m3_mul_v3(normal_ecef, ground->frame->r_ecef_from_enu, normal_frame);
    m3_tmul_v3(out->normal_enu, r_ecef_from_enu, normal_ecef);
    out->hot_m = place.h_m;
    out->hat_m = height_m - place.h_m;
    out->material = (uint32_t)landscape_surface(ground->landscape, at_enu[0], at_enu[1]);
    return true;
}

static float azimuth_deg(const double n_enu[3]) { return (float)(atan2(n_enu[0], n_enu[1]) / rad_per_deg); }
static float elevation_deg(const double n_enu[3])
{
    return (float)(atan2(n_enu[2], hypot(n_enu[0], n_enu[1])) / rad_per_deg);
}

static void answer_height(CigiPacket *out, const CigiHatHotRequest *r, const CigiScene *scene, const CigiGround *ground)
{
    double     p_ecef[3], r_ecef_from_axes[9];
    Height     height = {0};
    const bool valid = cigi_scene_place(p_ecef, r_ecef_from_axes, scene, r->p, r->by_entity, r->entity) &&
                       height_at(&height, ground, p_ecef);
    if (r->type != cigi_request_extended) {
        const bool hot = r->type == cigi_request_hot;
        out->id = cigi_hat_hot_response;
        out->of.hat_hot_response = (CigiHatHotResponse){
            .id = r->id, .valid = valid, .hot = hot, .height_m = hot ? height.hot_m : height.hat_m};
        return;
    }
    const double *n = height.normal_enu;
    out->id = cigi_hat_hot_extended_response;
    out->of.hat_hot_extended_response = (CigiHatHotExtendedResponse){.id = r->id,
                                                                     .valid = valid,
                                                                     .hat_m = height.hat_m,
                                                                     .hot_m = height.hot_m,
                                                                     .material = height.material,
                                                                     .normal_azimuth_deg = azimuth_deg(n),
                                                                     .normal_elevation_deg = elevation_deg(n)};
}

/* A line of sight in the ground's frame. */
typedef struct Sight {
    double p_ecef[3], d_ecef[3]; /* unit direction */
    double least_m, most_m;      /* ranges at which a hit counts */
    bool   segment;              /* to a place, which is seen or not; else a direction */
} Sight;

static bool sight_between(Sight *out, const CigiScene *scene, const CigiLosSegmentRequest *r)
{
    static const double last_m = 0.05; /* before a place on the ground, which would hide itself */
    double              to_ecef[3], axes[9], line[3];
    if (!cigi_scene_place(out->p_ecef, axes, scene, r->from, r->from_entity, r->entity)) return false;
    const uint16_t other = r->other_entity ? r->destination_entity : r->entity;
    if (!cigi_scene_place(to_ecef, axes, scene, r->to, r->to_entity, other)) return false;
    v3_sub(line, to_ecef, out->p_ecef);
    out->segment = true;
    out->least_m = 0;
    out->most_m = v3_length(line) - last_m;
    return v3_normalize(out->d_ecef, line);
}

static bool sight_along(Sight *out, const CigiScene *scene, const CigiLosVectorRequest *r)
{
    const double a = (double)r->azimuth_deg * rad_per_deg, e = (double)r->elevation_deg * rad_per_deg;
    const double d[3] = {cos(e) * cos(a), cos(e) * sin(a), -sin(e)}; /* forward, right, down */
    double       axes[9];
    if (!cigi_scene_place(out->p_ecef, axes, scene, r->from, r->from_entity, r->entity)) return false;
    m3_mul_v3(out->d_ecef, axes, d);
    out->segment = false;
    out->least_m = (double)r->least_m;
    out->most_m = (double)r->most_m;
    return true;
}

/* Range to the ground, m; INFINITY: it is not met. */
static double range_of(const Sight *sight, const CigiGround *ground)
{
    Ground traced;
    double o_enu[3], d_enu[3];
    ground_prepare(&traced, &ground->landscape->elevation);
    enu_from_ecef(o_enu, ground->frame, sight->p_ecef);
    m3_tmul_v3(d_enu, ground->frame->r_ecef_from_enu, sight->d_ecef);
    return sight->most_m > 0 ? ground_first_hit(NULL, &traced, o_enu, d_enu, sight->most_m) : INFINITY;
}

/* known: the line is one, and there is ground. */
static void answer_sight(CigiPacket *out, uint16_t id, bool extended, const Sight *sight, bool known,
                         const CigiGround *ground)
{
    const double range_m = known ? range_of(sight, ground) : INFINITY;
    const bool   met = isfinite(range_m) && range_m >= sight->least_m;
    const bool   visible = known && sight->segment && !met;
    Height       height = {0};
    Geodetic     place = {0};
    double       p_ecef[3];
    out->id = extended ? cigi_los_extended_response : cigi_los_response;
    if (!extended) {
        out->of.los_response =
            (CigiLosResponse){.id = id, .valid = met, .visible = visible, .count = 1, .range_m = met ? range_m : 0};
        return;
    }
    CigiLosExtendedResponse *const x = &out->of.los_extended_response;
    *x = (CigiLosExtendedResponse){.id = id, .valid = known, .range_valid = met, .visible = visible, .count = 1};
    if (!met) return;
    v3_add_scaled(p_ecef, sight->p_ecef, range_m, sight->d_ecef);
    if (!height_at(&height, ground, p_ecef) || geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return;
    x->range_m = range_m;
    x->p[0] = place.lat_rad / rad_per_deg;
    x->p[1] = place.lon_rad / rad_per_deg;
    x->p[2] = place.h_m;
    x->alpha = 255;
    x->material = height.material;
    x->normal_azimuth_deg = azimuth_deg(height.normal_enu);
    x->normal_elevation_deg = elevation_deg(height.normal_enu);
}

static void answer_sensor(CigiPacket *out, const CigiSensorControl *c, uint32_t ig_frame)
{
    out->id = c->extended ? cigi_sensor_extended_response : cigi_sensor_response;
    if (c->extended)
        out->of.sensor_extended_response =
            (CigiSensorExtendedResponse){.view = c->view, .sensor = c->sensor, .frame = ig_frame};
    else out->of.sensor_response = (CigiSensorResponse){.view = c->view, .sensor = c->sensor, .frame = ig_frame};
}

bool cigi_answer(CigiPacket *out, const CigiPacket *request, const CigiScene *scene, const CigiGround *ground,
                 uint32_t ig_frame)
{
    CigiPacket answer = {0};
    Sight      sight = {0};
    bool       known;
    switch (request->id) {
    case cigi_hat_hot_request:
        answer_height(&answer, &request->of.hat_hot_request, scene, ground);
        break;
    case cigi_los_segment_request:
        known = sight_between(&sight, scene, &request->of.los_segment_request) && ground->landscape;
        answer_sight(&answer, request->of.los_segment_request.id, request->of.los_segment_request.extended, &sight,
                     known, ground);
        break;
    case cigi_los_vector_request:
        known = sight_along(&sight, scene, &request->of.los_vector_request) && ground->landscape;
        answer_sight(&answer, request->of.los_vector_request.id, request->of.los_vector_request.extended, &sight, known,
                     ground);
        break;
    case cigi_sensor_control:
        if (!request->of.sensor_control.on) return false;
        answer_sensor(&answer, &request->of.sensor_control, ig_frame);
        break;
    default:
        return false;
    }
    *out = answer;
    return true;
}
