/* render/materials/planck.h: blackbody radiance, spectral and in band. */
#ifndef RENDER_MATERIALS_PLANCK_H
#define RENDER_MATERIALS_PLANCK_H

#include "pitviper_response.h"

/* Spectral radiance, W / (m2 sr m); wavelength_m > 0, temp_k > 0, else NaN; 0 where it underflows. */
double planck_radiance(double wavelength_m, double temp_k);
/* In-band radiance, W / (m2 sr), and its derivative in T (may be NULL). Relative error < 1e-12 wherever the
 * result is a normal double; 0 where it underflows, NaN outside low < high, temp_k > 0. */
double planck_band(double low_m, double high_m, double temp_k, double *derivative);
/* Temperature of the blackbody with this in-band radiance; NaN for radiance_w_m2_sr <= 0. */
double planck_band_inverse(double low_m, double high_m, double radiance_w_m2_sr);

/* The same of what a band sees: in-band radiance weighted by its response, within 1e-8; without one to the bit those
 * above. */
double planck_seen(const SpectralBand *band, double temp_k, double *derivative);
double planck_seen_inverse(const SpectralBand *band, double radiance_w_m2_sr);

/* The fast one: a table in temperature, relative error < 1e-5 over 180 .. 1500 K (test_planck.c), the exact
 * function outside. */
typedef struct PlanckTable PlanckTable;
enum { planck_table_cells = 4096 };
Status planck_table_create(PlanckTable **out, double low_m, double high_m);
/* A band's response outlives the table. */
Status planck_table_seen(PlanckTable **out, const SpectralBand *band);
void   planck_table_destroy(PlanckTable *table);
double planck_table_radiance(const PlanckTable *table, double temp_k);
/* Eight at once, in float: within 4e-6 of the other; NaN for what is not above 0. */
void planck_table_radiance8(float radiance[8], const PlanckTable *table, const float temp_k[8]);
/* Inverse by the same table, |error| < 1 mK over 180 .. 1500 K. */
double planck_table_temp(const PlanckTable *table, double radiance_w_m2_sr);
/* The same of many, to the bit (test_planck.c), four at a time. */
void planck_table_temps(double *temp_k, const PlanckTable *table, const float *radiance_w_m2_sr, int count);

#endif
