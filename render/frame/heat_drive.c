/* render/frame/heat_drive.c: see heat_drive.h. */
#include "render/frame/heat_drive.h"

Status heat_drive_daylight(Daylight *out, const AirSource *source, const Geodetic *place, const Weather *weather, double unix_s)
{
    Sun sun;
    const double air_k = isfinite(weather->air_temp_k) ? weather->air_temp_k : 288.15;
    const Status status = sun_at(&sun, unix_s, place, weather->pressure_mbar, air_k - 273.15, NAN);
    if (status == STATUS_OK) daylight_at(out, source, weather, &sun);
    return status;
}

void heat_drive_weather(GroundWeather *out, double unix_s, const void *user)
{
    static const double thermometer_m = 2, anemometer_m = 10;
    const HeatDrive *drive = user;
    Weather          w;
    Daylight         light = {0};
    weather_at(&w, drive->course, unix_s);
    if (heat_drive_daylight(&light, &drive->source, &drive->place, &w, unix_s) != STATUS_OK) light.weather = w; /* beyond 1900 .. 2100: night */
    const double air_k = light.weather.air_temp_k;
    *out = (GroundWeather){.air = {air_k, w.humidity * saturation_pa(air_k), 100 * w.pressure_mbar, w.wind_mps, thermometer_m, anemometer_m},
                           .direct_w_m2 = light.solar_direct_w_m2, .diffuse_w_m2 = light.solar_diffuse_w_m2,
                           .longwave_w_m2 = stefan_w_m2k4 * pow(air_k, 4) - light.longwave_loss_w_m2,
                           .rain_kg_m2s = w.rain_mm_h / 3600};
    memcpy(out->sun_d_enu, light.sun_d_enu, sizeof out->sun_d_enu);
}
