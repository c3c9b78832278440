/* sensor/node/cigi/cigi_answer.c: heights above and of terrain for a CIGI host, and what is answered without them. */
#include "sensor/node/cigi/cigi_answer.h"

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

static void answer_height(CigiPacket *out, const CigiHatHotRequest *r, const CigiScene *scene, const CigiGround *ground)
{
    double     p_ecef[3];
    Height     height = {0};
    const bool valid =
        cigi_scene_place(p_ecef, scene, r->p, r->by_entity, r->entity) && height_at(&height, ground, p_ecef);
    if (r->type != cigi_request_extended) {
        const bool hot = r->type == cigi_request_hot;
        out->id = cigi_hat_hot_response;
        out->of.hat_hot_response = (CigiHatHotResponse){
            .id = r->id, .valid = valid, .hot = hot, .height_m = hot ? height.hot_m : height.hat_m};
        return;
    }
    const double *n = height.normal_enu;
    out->id = cigi_hat_hot_extended_response;
    out->of.hat_hot_extended_response =
        (CigiHatHotExtendedResponse){.id = r->id,
                                     .valid = valid,
                                     .hat_m = height.hat_m,
                                     .hot_m = height.hot_m,
                                     .material = height.material,
                                     .normal_azimuth_deg = (float)(atan2(n[0], n[1]) / rad_per_deg),
                                     .normal_elevation_deg = (float)(atan2(n[2], hypot(n[0], n[1])) / rad_per_deg)};
}

static void answer_sight(CigiPacket *out, uint16_t id, bool extended)
{
    out->id = extended ? cigi_los_extended_response : cigi_los_response;
    if (extended) out->of.los_extended_response = (CigiLosExtendedResponse){.id = id, .count = 1};
    else out->of.los_response = (CigiLosResponse){.id = id, .count = 1};
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
    switch (request->id) {
    case cigi_hat_hot_request:
        answer_height(&answer, &request->of.hat_hot_request, scene, ground);
        break;
    case cigi_los_segment_request:
        answer_sight(&answer, request->of.los_segment_request.id, request->of.los_segment_request.extended);
        break;
    case cigi_los_vector_request:
        answer_sight(&answer, request->of.los_vector_request.id, request->of.los_vector_request.extended);
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
