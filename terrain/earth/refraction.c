/* terrain/earth/refraction.c: how far lines of sight bend in air. */
#include "terrain/earth/refraction.h"

static const double earth_m = 6371e3; /* mean radius */

double refraction_bend(RefractionBand band, double eye_m, double ground_m)
{
    const double k = band == REFRACTION_RADAR ? 4.0 / 3 : 1.149, scale_m = band == REFRACTION_RADAR ? 7350 : 11000;
    if (!(isfinite(eye_m) && isfinite(ground_m))) return 0;
    const double low = fmax(fmin(eye_m, ground_m), 0) / scale_m, high = fmax(fmax(eye_m, ground_m), 0) / scale_m;
    const double apart = high - low;
    /* mean of exp(-h): expm1, since both ends may be near one another */
    const double mean = apart > 0 ? exp(-low) * (-expm1(-apart) / apart) : exp(-low);
    return (1 - 1 / k) / (2 * earth_m) * mean;
}

double refraction_bend_at(RefractionBand band, const LocalFrame *frame, const double eye_enu[3], double ground_enu_m)
{
    double   p_ecef[3];
    Geodetic place;
    ecef_from_enu(p_ecef, frame, eye_enu);
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return 0;
    return refraction_bend(band, place.h_m, frame->origin.h_m + (isfinite(ground_enu_m) ? ground_enu_m : 0));
}
