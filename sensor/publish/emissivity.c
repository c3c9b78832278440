/* sensor/publish/emissivity.c: emissivity of each pixel in a thermal band, from its material. */
#include "sensor/publish/emissivity.h"

void emissivity_plane(float *out, Band band, const Picture *picture, const Materials *materials)
{
    const size_t    count = (size_t)picture->width * (size_t)picture->height;
    const Material *row = materials->material;
    uint32_t        last = 0;
    float           value = NAN;
    for (size_t i = 0; i < count; i++) {
        const uint32_t material = picture->material[i];
        if (material != last) { /* neighbours are mostly of one material */
            const Material *m = material < (uint32_t)materials->count ? &row[material] : NULL;
            value = !m || material == 0 ? NAN
                    : band == BAND_MWIR ? 1 - m->rho_mwir - m->tau_mwir
                                        : 1 - m->rho_lwir - m->tau_lwir;
            last  = material;
        }
        out[i] = value;
    }
}
