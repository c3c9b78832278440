/* render/smoke/hot_gas.c: sums of grey gases for CO2 and H2O, and what cold air leaves of the 4.3 um band. */
#include "render/smoke/smoke.h"

const double hot_gas_co2_molar_kg = 0.04401, hot_gas_h2o_molar_kg = 0.018015;

enum { terms = hot_gas_terms, temps = 6, cold_columns = hot_gas_passed_nodes, cold_paths = 8 };
static const double at_temp_k[temps] = {300, 500, 700, 1100, 1500, 2300};

/* Fitted for columns of 1e-4 .. 10 atm m with weights 0 .. 1, by least squares of relative errors. */
static const double rate_per_atm_m[2][2][terms] = {
    /* [band][gas] */
    {{0.1, 0.5179, 2.683, 13.89, 71.97, 372.8, 1931, 1e+04}, {0.03162, 0.1, 0.3162, 1, 3.162, 10, 31.62, 100}},
    {{0.03162, 0.1, 0.3162, 1, 3.162, 10, 31.62, 100}, {0.03162, 0.1, 0.3162, 1, 3.162, 10, 31.62, 100}},
};
static const double weight[2][2][temps][terms] = {
    {
        {
            /* mwir, CO2 */
            {0.1311, 0.02541, 0.03733, 0.05053, 0.04798, 0.05825, 0.05201, 0.01982},
            {0.154, 0.0403, 0.04072, 0.04246, 0.04603, 0.08107, 0.0534, 0.007085},
            {0.1384, 0.04807, 0.04041, 0.04089, 0.0512, 0.1009, 0.04237, 0.001554},
            {0.05498, 0.05489, 0.04562, 0.04382, 0.07675, 0.1272, 0.01279, 0},
            {0.02499, 0.01271, 0.06276, 0.03117, 0.1373, 0.1106, 0, 9.5e-05},
            {0.02402, 0, 0.03145, 0, 0.2554, 0.04092, 0, 0},
        },
        {
            /* mwir, H2O */
            {0.2881, 0.01763, 0.02122, 0.007042, 0.001818, 0.000222, 1.7e-05, 0},
            {0.2725, 0.07197, 0.04657, 0.01716, 0.005733, 0.001534, 0.000203, 8e-06},
            {0.2666, 0.1092, 0.07024, 0.02843, 0.008889, 0.002079, 0.000254, 7e-06},
            {0.283, 0.1562, 0.1076, 0.04757, 0.013, 0.001832, 0.0001, 0},
            {0.3082, 0.2092, 0.1466, 0.06371, 0.01506, 0.001163, 1.6e-05, 0},
            {0.3033, 0.2543, 0.2053, 0.09052, 0.01947, 0.001323, 1e-05, 0},
        },
    },
    {
        {
            /* lwir, CO2 */
            {0.2034, 0.02351, 0.007265, 6.3e-05, 1e-06, 0, 0, 0},
            {0.3038, 0.1685, 0.08859, 0.0221, 0.001135, 0, 0, 0},
            {0.1186, 0.2882, 0.1732, 0.05438, 0.004325, 0, 0, 0},
            {0.07937, 0.2162, 0.2854, 0.06622, 0.003172, 0, 0, 0},
            {0.183, 0.1604, 0.2963, 0.03561, 0.000622, 1.1e-05, 0, 0},
            {0.03623, 0.3186, 0.1604, 0.003742, 9.6e-05, 3e-06, 0, 0},
        },
        {
            /* lwir, H2O */
            {0.5809, 0.004683, 0.02006, 0.004385, 0.000792, 6.4e-05, 1e-06, 0},
            {0.433, 0.1281, 0.08227, 0.03086, 0.01028, 0.002285, 0.000178, 1e-06},
            {0.3695, 0.1886, 0.1378, 0.07249, 0.03018, 0.009333, 0.001747, 8.4e-05},
            {0.1936, 0.2528, 0.2342, 0.1626, 0.0823, 0.03078, 0.007215, 0.000571},
            {1e-06, 0.2032, 0.2966, 0.2651, 0.1472, 0.05634, 0.01299, 0.00091},
            {0, 0.001479, 0.138, 0.3856, 0.3233, 0.1254, 0.02379, 0.002066},
        },
    },
};

/* Ratios for hot columns of 0.002, 0.02 and 0.2 atm m, behind 10 m .. 30 km of air. */
static const double at_column_atm_m[cold_columns] = {0.002, 0.02, 0.2};
static const double at_path_m[cold_paths] = {10, 30, 100, 300, 1000, 3000, 10000, 30000};
static const double passed[cold_columns][temps][cold_paths] = {
    /* [column of the hot gas][its temperature][path] */
    {
        /* 0.002 atm m */
        {0.134, 0.050, 0.016, 0.005, 0.002, 0.001, 0.000, 0.000},
        {0.196, 0.093, 0.037, 0.014, 0.006, 0.003, 0.001, 0.001},
        {0.275, 0.165, 0.089, 0.046, 0.023, 0.014, 0.008, 0.004},
        {0.412, 0.306, 0.221, 0.156, 0.107, 0.093, 0.068, 0.044},
        {0.537, 0.440, 0.357, 0.287, 0.220, 0.202, 0.174, 0.136},
        {0.745, 0.668, 0.606, 0.537, 0.448, 0.424, 0.400, 0.359},
    },
    {
        /* 0.02 atm m */
        {0.345, 0.190, 0.079, 0.029, 0.009, 0.004, 0.002, 0.001},
        {0.408, 0.261, 0.138, 0.067, 0.030, 0.016, 0.008, 0.005},
        {0.480, 0.348, 0.225, 0.139, 0.080, 0.054, 0.034, 0.020},
        {0.584, 0.480, 0.375, 0.291, 0.220, 0.178, 0.144, 0.113},
        {0.652, 0.566, 0.478, 0.406, 0.342, 0.300, 0.264, 0.236},
        {0.734, 0.667, 0.596, 0.535, 0.480, 0.443, 0.408, 0.376},
    },
    {
        /* 0.2 atm m */
        {0.533, 0.393, 0.246, 0.132, 0.055, 0.025, 0.012, 0.006},
        {0.575, 0.455, 0.330, 0.228, 0.141, 0.091, 0.055, 0.032},
        {0.628, 0.526, 0.421, 0.332, 0.250, 0.193, 0.141, 0.100},
        {0.708, 0.631, 0.553, 0.488, 0.427, 0.382, 0.338, 0.303},
        {0.754, 0.691, 0.627, 0.574, 0.525, 0.488, 0.451, 0.415},
        {0.778, 0.722, 0.666, 0.619, 0.575, 0.540, 0.499, 0.448},
    },
};

/* Place of x in ascending nodes: index of the left one, and the share of the right. */
static int place(double *share, const double *node, int count, double x, bool by_ratio)
{
    int i = 0;
    while (i + 2 < count && x >= node[i + 1]) i++;
    const double at =
        by_ratio ? log(x / node[i]) / log(node[i + 1] / node[i]) : (x - node[i]) / (node[i + 1] - node[i]);
    *share = clamp(at, 0, 1);
    return i;
}

void smoke_gas_weights(double out[2][hot_gas_terms], HotGasBand band, double temp_k)
{
    double    share;
    const int t = place(&share, at_temp_k, temps, temp_k, false);
    for (int gas = 0; gas < 2; gas++)
        for (int j = 0; j < terms; j++)
            out[gas][j] = weight[band][gas][t][j] + share * (weight[band][gas][t + 1][j] - weight[band][gas][t][j]);
}

/* 1 - exp(-depth) to 1e-12 of itself, in a quarter of expm1's time. */
static inline double absorbed(double depth)
{
    return depth > 1e-3 ? 1 - exp(-depth) : depth * (1 - depth * (0.5 - depth * (1.0 / 6 - depth * (1.0 / 24))));
}

void smoke_gas_start(HotGasRay *ray)
{
    for (int g = 0; g < 2; g++) {
        ray->taken[g] = 0;
        for (int j = 0; j < terms; j++) ray->left[g][j] = 1;
    }
}

double smoke_gas_through(HotGasRay *ray, HotGasBand band, HotGasColumn column, const double w[2][hot_gas_terms])
{
    const double atm_m[2] = {column.co2_atm_m, column.h2o_atm_m};
    for (int g = 0; g < 2; g++) {
        if (!(atm_m[g] > 0)) continue;
        for (int j = 0; j < terms; j++) {
            const double taken = ray->left[g][j] * absorbed(rate_per_atm_m[band][g][j] * atm_m[g]);
            ray->taken[g] += w[g][j] * taken;
            ray->left[g][j] -= taken;
        }
        ray->taken[g] = fmin(ray->taken[g], 1); /* weights of very different temperatures may sum to more */
    }
    /* not 1 - products: thin columns would cancel */
    return ray->taken[0] + ray->taken[1] - ray->taken[0] * ray->taken[1];
}

double smoke_gas_emissivity(HotGasBand band, HotGasColumn column, double temp_k)
{
    HotGasRay ray;
    double    w[2][hot_gas_terms];
    smoke_gas_start(&ray);
    smoke_gas_weights(w, band, temp_k);
    return smoke_gas_through(&ray, band, column, (const double(*)[hot_gas_terms])w);
}

void smoke_gas_passed_at(double at[hot_gas_passed_nodes], double temp_k, double range_m)
{
    double    s_temp, s_path;
    const int t = place(&s_temp, at_temp_k, temps, temp_k, false);
    const int p = place(&s_path, at_path_m, cold_paths, fmax(range_m, 1e-9), true);
    for (int c = 0; c < cold_columns; c++) {
        const double near_k = passed[c][t][p] + s_temp * (passed[c][t + 1][p] - passed[c][t][p]);
        const double far_k = passed[c][t][p + 1] + s_temp * (passed[c][t + 1][p + 1] - passed[c][t][p + 1]);
        at[c] = near_k + s_path * (far_k - near_k);
        /* nearer than the first node: absorption by the square root of the path, as strong lines absorb */
        if (range_m < at_path_m[0]) at[c] = 1 - (1 - at[c]) * sqrt(fmax(range_m, 0) / at_path_m[0]);
    }
}

double smoke_gas_passed_of(const double at[hot_gas_passed_nodes], double co2_atm_m)
{
    double    share;
    const int c = place(&share, at_column_atm_m, cold_columns, fmax(co2_atm_m, 1e-9), true);
    return at[c] + share * (at[c + 1] - at[c]);
}

double smoke_gas_passed(double co2_atm_m, double temp_k, double range_m)
{
    double at[hot_gas_passed_nodes];
    smoke_gas_passed_at(at, temp_k, range_m);
    return smoke_gas_passed_of(at, co2_atm_m);
}

double smoke_gas_atm_m(double kg_m2, double molar_kg, double temp_k)
{
    static const double gas_j_mol_k = 8.314462618, pa_per_atm = 101325;
    return kg_m2 / molar_kg * gas_j_mol_k * temp_k / pa_per_atm;
}
