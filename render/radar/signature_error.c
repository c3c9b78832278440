/* render/radar/signature_error.c: see signature_error.h. */
#include "render/radar/signature_error.h"

/* Of a tube's power, what is error: fitted to a tank at 10 and 35 GHz. Co-polarised fields are mostly of whole faces, whose
 * tubes are wrong at their edges alone; cross-polarised ones of edges and corners. */
static const double same_share = 0.25, cross_share = 0.9;

void signature_error(SignatureError *out, const Centres *centres)
{
    *out = (SignatureError){same_share * centres->tubes_same_m2, cross_share * centres->tubes_cross_m2};
}

double signature_error_db(double complex s, double error_m2)
{
    const double amplitude = cabs(s);
    return amplitude > 0 ? 10 * log10(1 + sqrt(2 * error_m2) / amplitude) : NAN;
}
