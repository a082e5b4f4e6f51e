#pragma once

#include <hshfit/transfer/shading.h>

#include <cstddef>

namespace hshfit::inline transfer {

/// out[v] = sum over slots of brdf[slot * slotStep + v * vertexStep] light[slot * vertices + v];
/// vertexStep is 0 or 1.
struct DotJob {
    const float* brdf;
    std::size_t slotStep;
    bool perVertex;
    const float* light;
    std::size_t slots, vertices;
    float* out;
};
void shadeDots(const DotJob& job);

/// Rows of a table by elevation: [channel][slot][elevation], elevations + 1 in a row.
struct TableJob {
    const float* table;
    int order;
    bool bilateral;
    std::size_t channels, elevations;
    ShadingViews views;
    const float* light;
    float* out;
};
void shadeTable(const TableJob& job);

}  // namespace hshfit::inline transfer
