/* render/air.c: a clear sky from five numbers of weather and the sun's place.
 *
 * Every coefficient below was fitted to band averages computed with LOWTRAN 7 (Kneizys et al., AFGL 1988),
 * rural aerosol, ground at sea level, visibilities of 23 and 5 km; visible: US standard and mid-latitude
 * summer, thermal: all six of its standard atmospheres. tests/render/test_air.c measures the errors:
 *
 *   direct sun      PAN 1 %, B G R 4 % to zenith 70 degrees; 8 % at 80
 *   diffuse sky     4 % to zenith 80 degrees
 *   sky by direction 15 % rms, 15 degrees and more from the sun; inside, an aureole about three times too faint
 *   transmittance   MWIR 0.019, LWIR 0.016 at worst (absolute), 0.1 .. 20 km along the ground
 *   thermal sky     LWIR 4 %, MWIR 7 % (US standard and mid-latitude summer); 10 % in the others
 *   sun in MWIR     8 % to zenith 80 degrees; its scattered part within a factor of 1.6
 *
 * Visibilities below 5 km are extrapolated: the aerosol only grows, and a true fog (droplets, opaque in LWIR
 * too) is not here. Nor are clouds, the observer's height (every path is as if along the ground, so a steep
 * one is seen through too much air), and the dependence of a band's transmittance on the target's own
 * temperature (taken at 300 K). LOWTRAN itself is 5 .. 17 % from newer models in MWIR. */
#include "render/air.h"

/* ---- the visible -------------------------------------------------------------------------- */

/* One channel. aerosol: extinction of the aerosol at 0.55 um, 1/km. */
typedef struct Channel {
    double top_w_m2;            /* outside the air, at 1 au */
    double clear_per_km;        /* horizontal extinction of clean air: Rayleigh, ozone, water lines */
    double aerosol_ratio;       /* horizontal aerosol extinction over that at 0.55 um */
    double depth[2], power[2];  /* vertical optical depth, and the power of the air mass it grows with (a band is
                                 * not one wavelength): value = [0] + [1] * aerosol */
    double total[2], bend[2];   /* global on a horizontal plane; see global_transmittance */
} Channel;

static const Channel channels[optical_channel_count] = {
    [optical_channel_b]   = {186.641, 0.0267, 1.2736, {0.3669, 1.7429}, {0.9948, 0.0112},
                             {0.1042, 0.3637}, {0.1087, 0.1307}},
    [optical_channel_g]   = {185.365, 0.0150, 1.0126, {0.2427, 1.3892}, {1.0022, 0.0119},
                             {0.0767, 0.3010}, {0.0474, 0.1109}},
    [optical_channel_r]   = {159.390, 0.0144, 0.8306, {0.1793, 1.1398}, {0.9896, 0.0253},
                             {0.0585, 0.2613}, {0.0459, 0.1008}},
    [optical_channel_pan] = {531.395, 0.0208, 1.0338, {0.2694, 1.4015}, {0.9619, -0.0105},
                             {0.0798, 0.3078}, {0.0683, 0.1129}},
};

static const double rayleigh_550nm_per_km = 0.01159; /* LOWTRAN 7, sea level */

/* Koschmieder: contrast 0.02 is left over one meteorological range, -ln 0.02 = 3.912. */
static double aerosol_per_km(double visibility_m)
{
    return fmax(3912 / visibility_m - rayleigh_550nm_per_km, 0);
}

/* Relative air mass. Source: Kasten & Young, Applied Optics 28 (1989) 4735; 38 at the horizon. */
static double air_mass(double elevation_rad)
{
    const double e_deg = fmax(elevation_rad, 0) / rad_per_deg;
    return 1 / (sin(fmax(elevation_rad, 0)) + 0.50572 * pow(e_deg + 6.07995, -1.6364));
}

/* Direct and scattered together, on a horizontal plane, over what arrives there at the top. The two-stream
 * form 1 / (1 + k m), with the air mass bent at both ends to follow the tables. Albedo of the ground: 0.2. */
static double global_transmittance(const Channel *c, double aerosol, double mass)
{
    const double k = c->total[0] + c->total[1] * aerosol, bend = c->bend[0] + c->bend[1] * aerosol;
    return 1 / (1 + k * mass * sqrt(mass) / (1 + bend * (mass - 1)));
}

/* Twilight: daylight below an elevation of 5 degrees, over its value there. Straight lines in its logarithm
 * through rounded values for a clear, moonless sky: 0.17 at the horizon, 8e-4 at the end of civil, 2e-6 of
 * nautical, 3e-7 (airglow and stars) of astronomical twilight. Right within a factor of two. */
static double twilight(double elevation_rad)
{
    static const double at_deg[] = {-18, -12, -6, 0, 5}, decades[] = {-6.5, -5.7, -3.1, -0.77, 0};
    const double e_deg = elevation_rad / rad_per_deg;
    if (e_deg <= at_deg[0]) return pow(10, decades[0]);
    for (int i = 1; i < 5; i++)
        if (e_deg <= at_deg[i]) {
            const double f = (e_deg - at_deg[i - 1]) / (at_deg[i] - at_deg[i - 1]);
            return pow(10, decades[i - 1] + f * (decades[i] - decades[i - 1]));
        }
    return 1;
}

static const double sun_radius_rad = 0.2665 * 0.017453292519943295769; /* mean over the year */

/* Share of the sun's disc above the horizon. */
static double disc_above(double elevation_rad)
{
    return clamp((elevation_rad + sun_radius_rad) / (2 * sun_radius_rad), 0, 1);
}

double air_sun_disc(const Air *air, const double d_enu[3])
{
    /* by the chord, since the cosine of so small an angle has lost half its digits */
    double chord[3];
    v3_sub(chord, d_enu, air->sun_d_enu);
    const double disc = 2 * sin(0.5 * sun_radius_rad), disc2 = disc * disc;
    return v3_dot(chord, chord) < disc2 ? 1 / (pi_rad * disc2) : 0; /* pi chord^2: exact on the sphere */
}

static void sun_and_sky(double *sun_w_m2, double *sky_w_m2, const Channel *c, double aerosol, double elevation_rad,
                        double distance_au)
{
    const double top = c->top_w_m2 / (distance_au * distance_au), mass = air_mass(elevation_rad);
    /* the power's slope is known between the two visibilities only; it stops at 2 km */
    const double power = c->power[0] + c->power[1] * fmin(aerosol, 2);
    *sun_w_m2 = top * exp(-(c->depth[0] + c->depth[1] * aerosol) * pow(mass, power)) * disc_above(elevation_rad);

    const double day_rad = fmax(elevation_rad, 5 * rad_per_deg), day_mass = air_mass(day_rad);
    const double direct = exp(-(c->depth[0] + c->depth[1] * aerosol) * pow(day_mass, power));
    *sky_w_m2 = top * sin(day_rad) * (global_transmittance(c, aerosol, day_mass) - direct) * twilight(elevation_rad);
}

/* Kruse's exponent of the aerosol is constant above 6 km and goes as the cube root of visibility below
 * (Kruse, McGlauchlin, McQuistan, Elements of Infrared Technology, 1962): haze turns white as it thickens. */
static double channel_extinction_per_m(const Channel *c, double aerosol, double visibility_m)
{
    const double whiter = visibility_m < 5000 ? cbrt(visibility_m / 5000) : 1;
    return 1e-3 * (c->clear_per_km + pow(c->aerosol_ratio, whiter) * aerosol);
}

/* The sky is single scattering in a plane layer (by height, with its depth) times a phase function (by angle from
 * the sun), plus light that has forgotten where it came from. Fit: the phase function, this share, and the 0.72
 * that air_at puts on the depth. */
static const double sky_even = 0.315;

static double sky_phase(double cos_from_sun)
{
    const double x = cos_from_sun - 1;
    /* the aureole is 1e-10 of the rest beyond 45 degrees */
    return 1 + 5.0 * exp(4.61 * x) + (x > -0.3 ? 25 * exp(85 * x) : 0);
}

/* Air mass 1 / (up + 0.025): 40 at the horizon, no arc cosine. A sun lower than 8.6 degrees lights the sky as if it
 * stood there: in twilight the light comes from above. */
static double sky_path(double depth, double sun_up, double up)
{
    const double mass = 1 / (up + 0.025), sun_mass = 1 / fmax(sun_up, 0.15);
    const double q = depth * (mass - sun_mass);
    const double mean = fabs(q) > 1e-6 ? -expm1(-q) / q : 1; /* of e^-x over the path: 0 / 0 at equal masses */
    return mass * depth * exp(-depth * sun_mass) * mean;
}

/* Sets the scales so that the sky's radiance, weighted by the sine of its height, adds up to its irradiance: Gauss
 * in the square root of elevation, in two halves (the horizon changes fastest), equal steps in azimuth (periodic, so
 * exact before long), one half by symmetry about the sun. The angle from the sun is common to all channels. */
static void normalise_sky(Air *air)
{
    enum { gauss = 16, heights = 2 * gauss, azimuths = 36 };
    static const double node[gauss / 2] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274,
                                           0.6178762444026437, 0.7554044083550030, 0.8656312023878317,
                                           0.9445750230732326, 0.9894009349916499};
    static const double weight[gauss / 2] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025,
                                             0.1495959888165767, 0.1246289712555339, 0.0951585116824928,
                                             0.0622535239386479, 0.0271524594117541};
    const double sun_up = air->sun_d_enu[2], sun_level = sqrt(fmax(1 - sun_up * sun_up, 0));
    double cos_azimuth[azimuths], horizon_phase = 0;
    for (int a = 0; a < azimuths; a++) {
        cos_azimuth[a] = cos((a + 0.5) * pi_rad / azimuths);
        horizon_phase += sky_phase(sun_level * cos_azimuth[a]) / azimuths;
    }
    double irradiance[optical_channel_count] = {0};
    for (int h = 0; h < heights; h++) {
        const int k = h % gauss / 2;
        const double u = 0.25 * (1 + (h & 1 ? node[k] : -node[k])) + (h < gauss ? 0 : 0.5);
        const double elevation_rad = 0.5 * pi_rad * u * u, up = sin(elevation_rad), level = cos(elevation_rad);
        double phase = 0;
        for (int a = 0; a < azimuths; a++)
            phase += sky_phase(up * sun_up + level * sun_level * cos_azimuth[a]) / azimuths;
        /* up d solid angle = 2 pi up level d elevation, d elevation = pi u du, du: a quarter of Gauss's unit */
        const double share = 0.5 * pi_rad * pi_rad * up * level * u * weight[k];
        for (int c = 0; c < optical_channel_count; c++)
            irradiance[c] += share * (sky_path(air->sky_depth[c], sun_up, up) * phase + sky_even);
    }
    for (int c = 0; c < optical_channel_count; c++) {
        air->sky_scale[c] = air->sky_w_m2[c] / irradiance[c];
        air->horizon_w_m2_sr[c] =
            air->sky_scale[c] * (sky_path(air->sky_depth[c], sun_up, 0) * horizon_phase + sky_even);
    }
}

/* ---- the thermal bands -------------------------------------------------------------------- */

/* Water vapour, g/m3. Saturation: Magnus form of Alduchov & Eskridge, J. Appl. Meteor. 35 (1996) 601. */
static double vapour_g_m3(const Weather *weather)
{
    const double t_c = weather->air_temp_k - 273.15;
    const double e_hpa = weather->relative_humidity * 6.1094 * exp(17.625 * t_c / (t_c + 243.04));
    return fmin(216.7 * e_hpa / weather->air_temp_k, 30);
}

/* Emissivity of the sky at a height: 1 - exp(-depth mass^power). Air mass: Rozenberg, Twilight, 1966. */
static double sky_emissivity(double depth, double power, double up)
{
    return -expm1(-depth * pow(1 / (up + 0.025 * exp(-11 * up)), power));
}

static double sky_mean(const double sky_w_m2_sr[air_sky_steps + 1])
{
    /* the mean weighted by 2 up d up = 4 u^3 du over the table's straight pieces, by Simpson's rule (exact for
     * their product, a quartic, to 1e-8) */
    double sum = 0;
    for (int i = 0; i < air_sky_steps; i++) {
        const double a = (double)i / air_sky_steps, b = (i + 1.0) / air_sky_steps, m = 0.5 * (a + b);
        const double middle = 0.5 * (sky_w_m2_sr[i] + sky_w_m2_sr[i + 1]);
        sum += (a * a * a * sky_w_m2_sr[i] + 4 * m * m * m * middle + b * b * b * sky_w_m2_sr[i + 1]) / 6;
    }
    return 4 * sum / air_sky_steps;
}

static void thermal_air(Air *air, double aerosol, double elevation_rad, double distance_au)
{
    const Weather *weather = &air->weather;
    const double w = vapour_g_m3(weather), root_w = sqrt(w), air_temp_k = weather->air_temp_k;

    /* fitted in kilometres; 1000^-0.25 and 1000^-0.5 bring the roots to metres */
    air->saturating_mwir       = 0.17782794100389229 * (0.42568 + 0.02118 * root_w + 0.00143 * w);
    air->extinction_mwir_per_m = 1e-3 * (0.01623 + 0.00476 * w + 1e-5 * w * w + 0.10861 * aerosol);
    air->saturating_lwir       = 0.03162277660168379 * (0.00863 + 0.02513 * root_w + 0.00073 * w);
    air->extinction_lwir_per_m = 1e-3 * (0.00092 + 0.00463 * w + 0.00059 * w * w + 0.08817 * aerosol);

    const double mass = air_mass(elevation_rad);
    const double top_mwir_w_m2 = 12.7887 / (distance_au * distance_au);
    air->sun_mwir_w_m2 = top_mwir_w_m2 * disc_above(elevation_rad) *
                         exp(-(0.3663 + 0.0223 * pow(w, 0.8753)) * pow(mass, 0.5015) - 0.1479 * aerosol * mass);
    const double up = sin(elevation_rad);
    const double scattered_mwir =
        up > 0 ? top_mwir_w_m2 * 0.0973 * aerosol / (1 + 0.5656 * aerosol) * pow(up, 0.7337) / pi_rad : 0;

    air->air_mwir_w_m2_sr = planck_table_radiance(air->planck_mwir, air_temp_k);
    air->air_lwir_w_m2_sr = planck_table_radiance(air->planck_lwir, air_temp_k);
    const double a = fmin(aerosol, 2); /* as above: the power is not known further */
    const double depth_mwir = 0.67632 - 0.02478 * w + 0.00156 * w * w + 0.12504 * aerosol;
    const double power_mwir = 0.43386 - 0.00448 * w + 0.05137 * a;
    const double depth_lwir = 0.09144 + 0.01041 * w + 0.00074 * w * w + 0.12247 * aerosol;
    const double power_lwir = 0.76869 - 0.00062 * w + 0.08101 * a;
    for (int i = 0; i <= air_sky_steps; i++) {
        const double u = (double)i / air_sky_steps, d_up = u * u;
        air->sky_mwir_w_m2_sr[i] = scattered_mwir +
                                   air->air_mwir_w_m2_sr * sky_emissivity(depth_mwir, power_mwir, d_up);
        air->sky_lwir_w_m2_sr[i] = air->air_lwir_w_m2_sr * sky_emissivity(depth_lwir, power_lwir, d_up);
    }
    air->sky_mean_mwir_w_m2_sr = sky_mean(air->sky_mwir_w_m2_sr);
    air->sky_mean_lwir_w_m2_sr = sky_mean(air->sky_lwir_w_m2_sr);

    /* For temperatures. 0.44 of the daylight that reaches the ground lies in 0.4-0.7 um (the photosynthetic
     * share: 0.43 .. 0.46 under clear skies); against Haurwitz's clear-sky formula that is right to 10 %. */
    static const double visible_share = 0.44;
    air->solar_direct_w_m2  = air->sun_w_m2[optical_channel_pan] / visible_share;
    air->solar_diffuse_w_m2 = air->sky_w_m2[optical_channel_pan] / visible_share;

    /* What a black horizontal plane at air temperature loses to a clear sky. Brunt's form (Q. J. R. Meteor. Soc. 58,
     * 1932) with its two coefficients fitted to LOWTRAN's downward flux in the six atmospheres: within 4.5 %. */
    static const double sigma_w_m2_k4 = 5.670374419184429e-8;
    const double emissivity = fmin(0.66 + 0.034 * sqrt(w * air_temp_k / 216.7), 1); /* vapour pressure in hPa */
    const double t2 = air_temp_k * air_temp_k;
    air->longwave_loss_w_m2 = (1 - emissivity) * sigma_w_m2_k4 * t2 * t2;

    /* Ground seen from below by what leans over it: grass, 18 K above the air at 1000 W/m2 (etc/ground_heat.csv) */
    const double ground_temp_k =
        air_temp_k + 0.018 * (air->solar_direct_w_m2 * fmax(air->sun_d_enu[2], 0) + air->solar_diffuse_w_m2);
    air->ground_mwir_w_m2_sr = planck_table_radiance(air->planck_mwir, ground_temp_k);
    air->ground_lwir_w_m2_sr = planck_table_radiance(air->planck_lwir, ground_temp_k);
}

/* ---- all of it ---------------------------------------------------------------------------- */

void air_at(Air *out, const Weather *weather, const Sun *sun, const PlanckTable *mwir, const PlanckTable *lwir)
{
    *out = (Air){.weather = *weather, .planck_mwir = mwir, .planck_lwir = lwir};
    memcpy(out->sun_d_enu, sun->d_enu, sizeof out->sun_d_enu);

    const double aerosol = aerosol_per_km(weather->visibility_m);
    for (int c = 0; c < optical_channel_count; c++) {
        const Channel *channel = &channels[c];
        sun_and_sky(&out->sun_w_m2[c], &out->sky_w_m2[c], channel, aerosol, sun->elevation_rad, sun->distance_au);
        out->extinction_per_m[c] = channel_extinction_per_m(channel, aerosol, weather->visibility_m);
        /* 3: a layer so thick is even all over, and a horizon forty times thicker still has an exponential */
        out->sky_depth[c] = fmin(0.72 * (channel->depth[0] + channel->depth[1] * aerosol), 3);
    }
    normalise_sky(out);
    thermal_air(out, aerosol, sun->elevation_rad, sun->distance_au);
}

double air_sky_optical(const Air *air, int channel, const double d_enu[3])
{
    double d[3] = {d_enu[0], d_enu[1], d_enu[2]};
    if (d[2] < 0) {
        d[2] = 0;
        if (!v3_normalize(d, d)) d[0] = 1; /* straight down: any horizon */
    }
    return air->sky_scale[channel] * (sky_path(air->sky_depth[channel], air->sun_d_enu[2], d[2]) *
                                          sky_phase(v3_dot(d, air->sun_d_enu)) + sky_even);
}

static double sky_at(const double sky_w_m2_sr[air_sky_steps + 1], double d_up)
{
    const double at = air_sky_steps * sqrt(clamp(d_up, 0, 1));
    const int i = at < air_sky_steps ? (int)at : air_sky_steps - 1;
    return sky_w_m2_sr[i] + (at - i) * (sky_w_m2_sr[i + 1] - sky_w_m2_sr[i]);
}

double air_sky_mwir(const Air *air, double d_up)
{
    return sky_at(air->sky_mwir_w_m2_sr, d_up);
}

double air_sky_lwir(const Air *air, double d_up)
{
    return sky_at(air->sky_lwir_w_m2_sr, d_up);
}

/* Koschmieder: a long path turns into the horizon. */
Veil air_veil_optical(const Air *air, int channel, double range_m)
{
    const double tau = exp(-air->extinction_per_m[channel] * range_m);
    return (Veil){tau, (1 - tau) * air->horizon_w_m2_sr[channel]};
}

Veil air_veil_mwir(const Air *air, double range_m)
{
    const double tau = exp(-air->saturating_mwir * sqrt(sqrt(range_m)) - air->extinction_mwir_per_m * range_m);
    return (Veil){tau, (1 - tau) * air->air_mwir_w_m2_sr};
}

Veil air_veil_lwir(const Air *air, double range_m)
{
    const double tau = exp(-air->saturating_lwir * sqrt(range_m) - air->extinction_lwir_per_m * range_m);
    return (Veil){tau, (1 - tau) * air->air_lwir_w_m2_sr};
}
