/* tests/render/test_channels.c: a channel of etc/channels.csv in the place of another: its air and sun against other
 * published figures, and which channel is in a place. */
#include "pitviper_channels.h"
#include "render/air/atmosphere.h"
#include "render/materials/materials.h"
#include "tests/check.h"

static void choose(const char *name)
{
    const SpectralChannel *channel = channel_named(name, strlen(name));
    CHECK(channel != NULL);
    channels_standard();
    if (channel) channel_choose(channel);
}

static void places_are_the_standard_ones(void **state)
{
    (void)state;
    static const char *const name[SPECTRAL_PLACES] = {"b", "g", "r", "pan", "nir", "mwir", "lwir"};
    channels_standard();
    CHECK(channels_load() == STATUS_OK);
    for (int p = 0; p < SPECTRAL_PLACES; p++)
        CHECK(strcmp(channel_in((ChannelPlace)p)->name, name[p]) == 0 && channel_in((ChannelPlace)p)->standard);
    double low_m, high_m;
    air_band_edges(&low_m, &high_m, AIR_B);
    CHECK(low_m == 0.4e-6 && high_m == 0.5e-6); /* as written, to the last bit */
    air_band_edges(&low_m, &high_m, AIR_MWIR);
    CHECK(low_m == 3.4e-6 && high_m == 4.8e-6);
    CHECK(channel_named("radar", 5) == NULL && channel_named("sw", 2) == NULL);
}

/* Sun and air of 1.0-1.7 um. */
static void swir_is_what_others_say(void **state)
{
    (void)state;
    choose("swir");
    CHECK(strcmp(air_band_name(AIR_NIR), "swir") == 0);
    Atmosphere *us1976, *summer;
    CHECK(atmosphere_open_at(&us1976, "us1976", 23000) == STATUS_OK);
    CHECK(atmosphere_open_at(&summer, "midlat_summer", 23000) == STATUS_OK);
    SunAir sun;
    /* ASTM G173-03: 285.2 W/m2 above the air; 196.7 facing the sun through an air mass of 1.5 and a turbidity of 0.084
     * at 0.5 um, of which haze of 23 km has three times as much: half as clear in this band is less than 8 % */
    atmosphere_sun(&sun, us1976, 23000, AIR_NIR, 50000, 0);
    CHECK_NEAR(sun.direct_normal_w_m2, 285.2, 0.04 * 285.2);
    atmosphere_sun(&sun, us1976, 23000, AIR_NIR, 0, 48.236 * rad_per_deg);
    CHECK_NEAR(sun.direct_normal_w_m2, 196.7, 0.12 * 196.7);
    /* pvlib's spectrl2 at that air mass and three times that turbidity: 11.7 W/m2 diffuse to 156.5 direct, 0.075 */
    const double diffuse_w_m2 = sun.diffuse_horizontal_w_m2;
    CHECK_NEAR(diffuse_w_m2 / sun.direct_normal_w_m2, 0.075, 0.025);
    /* MODTRAN 5.2.1, straight down from 1 km, weighted by that sunlight: 0.7301; LOWTRAN7's water is 2.5 % low there */
    PathAir path;
    atmosphere_path(&path, summer, 23000, AIR_NIR,
                    &(AirPath){.observer_m = 1000, .target_m = 0, .range_m = 1000, .sun_zenith_rad = 0.87}, 300);
    CHECK_NEAR(path.sun_transmittance, 0.7301, 0.04 * 0.7301);
    /* 190 W/m2 on haze of 0.05 a km, a phase of 0.2 / (4 pi) at 130 degrees: 0.15 by one scattering of the sun; sky and
     * ground add about as much, which is known to a third of the sum: half and double are not within it */
    CHECK_NEAR(path.scattered_w_m2_sr, 0.3, 0.1);
    SkyAir sky;
    atmosphere_sky(&sky, us1976, 23000, AIR_NIR, 0, 0.5, 0.8, 2);
    /* half way up, away from the sun, a clear sky has some 0.4 of its mean, which is the diffuse light over pi */
    CHECK_NEAR(sky.scattered_w_m2_sr * pi_rad / diffuse_w_m2, 0.4, 0.15);
    CHECK(sky.thermal_w_m2_sr == 0);
    atmosphere_close(us1976);
    atmosphere_close(summer);
    channels_standard();
}

/* Plants are darker than in 0.7-1.1 um, water and ice dark. */
static void swir_of_materials(void **state)
{
    (void)state;
    Materials nir, swir;
    char      path[1024], surfaces[1024];
    CHECK(etc_path(path, sizeof path, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    channels_standard();
    CHECK(materials_open(&nir, path, surfaces, NULL) == STATUS_OK);
    choose("swir");
    CHECK(materials_open(&swir, path, surfaces, NULL) == STATUS_OK);
    channels_standard();
    const int grass = materials_find(&nir, "grass_green"), water = materials_find(&nir, "water_tap"),
              snow = materials_find(&nir, "snow_coarse");
    CHECK(swir.material[grass].rho[AIR_NIR] < 0.8f * nir.material[grass].rho[AIR_NIR]);
    CHECK(swir.material[snow].rho[AIR_NIR] < 0.7f * nir.material[snow].rho[AIR_NIR]);
    CHECK(swir.material[water].rho[AIR_NIR] < 0.03f &&
          swir.material[grass].rho[AIR_R] == nir.material[grass].rho[AIR_R]);
    materials_close(&nir);
    materials_close(&swir);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_the_standard_ones),
        cmocka_unit_test(swir_is_what_others_say),
        cmocka_unit_test(swir_of_materials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
