/* terrain/earth/geodesy.cpp: the only file that knows GeographicLib; and frames about a place. Degrees, exceptions and
 * std:: end here. */
#include "terrain/earth/geodesy.h"

#include <GeographicLib/Geocentric.hpp>

#include <algorithm>
#include <cmath>
#include <new>

namespace
{

const double deg_per_rad = 57.295779513082320877;
const double half_pi_rad = 1.5707963267948966192;

/* As Geocentric::Forward gives it, which would take memory. */
void rotation_at(double r_ecef_from_enu[9], double lat_deg, double lon_deg)
{
    double sin_lat, cos_lat, sin_lon, cos_lon;
    GeographicLib::Math::sincosd(lat_deg, sin_lat, cos_lat);
    GeographicLib::Math::sincosd(lon_deg, sin_lon, cos_lon);
    const double east[3] = {-sin_lon, cos_lon, 0}, up[3] = {cos_lat * cos_lon, cos_lat * sin_lon, sin_lat};
    const double north[3] = {-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat};
    for (int k = 0; k < 3; k++) {
        r_ecef_from_enu[3 * k] = east[k];
        r_ecef_from_enu[3 * k + 1] = north[k];
        r_ecef_from_enu[3 * k + 2] = up[k];
    }
}

} // namespace

extern "C" Status geodetic_from_ecef(Geodetic *out, const double p_ecef[3])
try {
    for (int i = 0; i < 3; i++)
        if (!std::isfinite(p_ecef[i])) return STATUS_BAD_VALUE;
    double lat_deg, lon_deg, h_m;
    GeographicLib::Geocentric::WGS84().Reverse(p_ecef[0], p_ecef[1], p_ecef[2], lat_deg, lon_deg, h_m);
    if (!(std::isfinite(lat_deg) && std::isfinite(lon_deg) && std::isfinite(h_m))) return STATUS_BAD_VALUE;

    /* the last bit of the product must not carry a pole beyond itself */
    out->lat_rad = std::min(half_pi_rad, std::max(-half_pi_rad, lat_deg * rad_per_deg));
    out->lon_rad = std::min(pi_rad, std::max(-pi_rad, lon_deg * rad_per_deg));
    out->h_m = h_m;
    return STATUS_OK;
} catch (const std::bad_alloc &) {
    return STATUS_NO_MEMORY;
} catch (...) {
    return STATUS_BAD_VALUE;
}

extern "C" Status ecef_from_geodetic(double p_ecef[3], double r_ecef_from_enu[9], const Geodetic *place)
try {
    if (!(std::isfinite(place->lat_rad) && std::isfinite(place->lon_rad) && std::isfinite(place->h_m)))
        return STATUS_BAD_VALUE;
    if (!(std::fabs(place->lat_rad) <= half_pi_rad)) return STATUS_BAD_VALUE;

    const double lat_deg = std::min(90.0, std::max(-90.0, place->lat_rad * deg_per_rad));
    const double lon_deg = place->lon_rad * deg_per_rad;
    double       x_m, y_m, z_m;
    GeographicLib::Geocentric::WGS84().Forward(lat_deg, lon_deg, place->h_m, x_m, y_m, z_m);
    if (!(std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(z_m))) return STATUS_BAD_VALUE;
    if (r_ecef_from_enu) rotation_at(r_ecef_from_enu, lat_deg, lon_deg);
    p_ecef[0] = x_m;
    p_ecef[1] = y_m;
    p_ecef[2] = z_m;
    return STATUS_OK;
} catch (const std::bad_alloc &) {
    return STATUS_NO_MEMORY;
} catch (...) {
    return STATUS_BAD_VALUE;
}

extern "C" Status local_frame_at(LocalFrame *out, const Geodetic *origin)
{
    LocalFrame frame = {};
    frame.origin = *origin;
    const Status status = ecef_from_geodetic(frame.origin_ecef, frame.r_ecef_from_enu, origin);
    if (status != STATUS_OK) return status;
    *out = frame;
    return STATUS_OK;
}
