/* tests/render/signatures_stage.h: signatures of a vehicle, asked for and seen. */
#ifndef TESTS_RENDER_SIGNATURES_STAGE_H
#define TESTS_RENDER_SIGNATURES_STAGE_H

#include "tests/check.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/signatures/signatures.h"

static const double frequency_hz = 5e9, aspect_rad = 0.3 * rad_per_deg;

static inline ScatterAntenna at(double az_deg, double el_deg, double range_m)
{
    const double   az = az_deg * rad_per_deg, el = el_deg * rad_per_deg;
    ScatterAntenna a = {{cos(el) * cos(az), cos(el) * sin(az), sin(el)}, range_m};
    return a;
}

static inline Signatures *open(Catalog **catalog, int *model, RadarMaterials *materials, size_t most_octets)
{
    static const DisEntityType truck = {1, 1, 225, 7, 1, 0, 0};
    const SignaturesConfig     config = {.frequency_hz = frequency_hz,
                                         .bandwidth_hz = 5e8,
                                         .aspect_rad = aspect_rad,
                                         .rays_per_wavelength = 1,
                                         .most_octets = most_octets,
                                         .isa = "avx2"};
    Signatures                *s;
    Origin                     origin;
    char                       path[4096];
    CHECK(etc_path(path, sizeof path, "catalog.csv") &&
          catalog_open(catalog, path, radar_sag_m(frequency_hz)) == STATUS_OK);
    *model = catalog_find(*catalog, truck, &origin, NULL);
    CHECK(radar_materials_load(materials) == STATUS_OK);
    CHECK(signatures_create(&s, &config, *catalog, materials) == STATUS_OK);
    return s;
}

static inline ScatterMatrix look(Signatures *s, int model, const double *joint, const ScatterAntenna *a)
{
    const Signature    *signature;
    const SignatureLook of = signature_look(a);
    Centres             centres = {0};
    ScatterMatrix       m;
    CHECK(signatures_find(&signature, s, model, joint, 0, &of, NULL) == STATUS_OK);
    CHECK(centres_make(&centres, signature, a, a, NULL) == STATUS_OK);
    centres_field(&m, &centres, frequency_hz);
    centres_free(&centres);
    return m;
}

#endif
