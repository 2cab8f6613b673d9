// Incident and outgoing wavelengths drawn from a material, and the integrals that they estimate.
//
//     sampling CUBE R G B
//
// A path from the light draws the wavelength that leaves, a path from the camera the incident one.
// Each estimate is compared with a sum over wavelengths; the program fails if they differ.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <upglow.h>

namespace {

void check(UpglowStatus status) {
    if (status != UPGLOW_STATUS_OK) {
        throw std::runtime_error(std::string(upglow_message()) + " (" +
                                 upglow_status_name(status) + ")");
    }
}

struct Destroy {
    void operator()(UpglowCube *cube) const { upglow_cube_destroy(cube); }
};
using Cube = std::unique_ptr<UpglowCube, Destroy>;

// From memory, as a program does whose assets are in an archive.
Cube load(const char *path) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    UpglowCube *cube = nullptr;
    check(upglow_cube_from_memory(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size(),
                                  &cube));
    return Cube(cube);
}

constexpr int DRAWS = 40000;
// Greatest error in standard deviations: a correct sampler exceeds it for one seed in a million, and
// does not for this one.
constexpr double DEVIATIONS = 5.0;
// Step of the midpoint sums; the curves change their slope every 1 nm.
constexpr float STEP_NM = 0.5f;
constexpr double QUADRATURE = 1e-4;
// Single precision, in a quotient of two numbers that are themselves sums.
constexpr double SINGLE = 1e-4;

constexpr float FIRST_NM = 300.0f;
constexpr float LAST_NM = 830.0f;

// An arbitrary light, which rises from violet to red.
double light(float lambda_nm) { return (lambda_nm - 200.0) / 600.0; }

float reflectance(const UpglowMaterial &material, float lambda_nm) {
    float value;
    check(upglow_reflectance(&material, lambda_nm, &value));
    return value;
}

float reradiation(const UpglowMaterial &material, float in_nm, float out_nm) {
    float value;
    check(upglow_reradiation(&material, in_nm, out_nm, &value));
    return value;
}

class Comparison {
  public:
    // `greatest` is the largest value that a draw can add.
    void compare(const char *what, double estimate, double truth, double greatest) {
        const double deviation =
            std::sqrt(std::max(0.0, truth * (greatest - truth)) / DRAWS) + greatest / DRAWS;
        const bool agree = std::abs(estimate - truth) <= DEVIATIONS * deviation + QUADRATURE;
        std::printf("%s estimate %.6f sum %.6f %s\n", what, estimate, truth,
                    agree ? "agree" : "DIFFER");
        differences_ += agree ? 0 : 1;
    }

    void expect(const char *what, bool holds) {
        if (holds) {
            return;
        }
        if (differences_ == 0) { // The first is enough: an error shows in every draw.
            std::printf("%s DIFFER\n", what);
        }
        differences_ += 1;
    }

    bool passed() const { return differences_ == 0; }

  private:
    int differences_ = 0;
};

bool close(double found, double expected) {
    return std::abs(found - expected) <= SINGLE * std::abs(expected);
}

// Light that is incident at one wavelength and leaves in a band.
void from_the_light(const UpglowMaterial &material, float in_nm, Comparison &comparison) {
    constexpr float BAND_NM[2] = {500.0f, 600.0f};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    double sum = 0.0, greatest = 0.0, kept = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        const float u[2] = {unit(random), unit(random)};
        UpglowSample sample;
        check(upglow_sample_outgoing(&material, in_nm, u, &sample));
        kept += sample.draw == UPGLOW_DRAW_ELASTIC ? 1.0 : 0.0;
        if (sample.draw != UPGLOW_DRAW_FLUORESCENT) {
            continue;
        }
        float per_nm;
        check(upglow_outgoing_pdf(&material, in_nm, sample.lambda_nm, &per_nm));
        comparison.expect("density of the light's draw", close(sample.pdf_per_nm, per_nm));
        comparison.expect("throughput of the light's draw",
                          close(reradiation(material, in_nm, sample.lambda_nm) / per_nm,
                                sample.throughput));
        greatest = std::max<double>(greatest, sample.throughput);
        if (sample.lambda_nm >= BAND_NM[0] && sample.lambda_nm < BAND_NM[1]) {
            sum += sample.throughput;
        }
    }
    double truth = 0.0;
    for (float nm = BAND_NM[0] + STEP_NM / 2; nm < BAND_NM[1]; nm += STEP_NM) {
        truth += reradiation(material, in_nm, nm) * STEP_NM;
    }
    comparison.compare("light", sum / DRAWS, truth, greatest);
    float probability;
    check(upglow_outgoing_elastic_probability(&material, in_nm, &probability));
    comparison.compare("light-elastic", kept / DRAWS, probability, 1.0);
}

// Light that leaves at one wavelength, integrated over incident wavelengths.
void from_the_camera(const UpglowMaterial &material, float out_nm, Comparison &comparison) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    double sum = 0.0, greatest = 0.0, kept = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        const float u[2] = {unit(random), unit(random)};
        UpglowSample sample;
        check(upglow_sample_incident(&material, out_nm, u, &sample));
        kept += sample.draw == UPGLOW_DRAW_ELASTIC ? 1.0 : 0.0;
        sum += sample.throughput * light(sample.lambda_nm);
        greatest = std::max(greatest, sample.throughput * light(LAST_NM));
        if (sample.draw == UPGLOW_DRAW_FLUORESCENT) {
            float per_nm;
            check(upglow_incident_pdf(&material, sample.lambda_nm, out_nm, &per_nm));
            comparison.expect("density of the camera's draw", close(sample.pdf_per_nm, per_nm));
        }
    }
    double truth = reflectance(material, out_nm) * light(out_nm);
    for (float nm = FIRST_NM + STEP_NM / 2; nm < LAST_NM; nm += STEP_NM) {
        truth += reradiation(material, nm, out_nm) * light(nm) * STEP_NM;
    }
    comparison.compare("camera", sum / DRAWS, truth, greatest);
    float probability;
    check(upglow_incident_elastic_probability(&material, out_nm, &probability));
    comparison.compare("camera-elastic", kept / DRAWS, probability, 1.0);
}

bool run(char **arguments) {
    const Cube cube = load(arguments[1]);
    const float rgb[3] = {std::strtof(arguments[2], nullptr), std::strtof(arguments[3], nullptr),
                          std::strtof(arguments[4], nullptr)};
    UpglowMaterial material;
    check(upglow_look_up(cube.get(), rgb, &material));
    bool fluorescent;
    check(upglow_is_fluorescent(&material, &fluorescent));
    std::printf("fluorescent %d\n", fluorescent ? 1 : 0);

    Comparison comparison;
    for (const float nm : {350.5f, 430.5f, 480.5f, 560.5f}) {
        from_the_light(material, nm, comparison);
        from_the_camera(material, nm, comparison);
    }
    return comparison.passed();
}

} // namespace

int main(int count, char **arguments) {
    if (count != 5) {
        std::fprintf(stderr, "usage: sampling CUBE R G B\n");
        return 2;
    }
    try {
        return run(arguments) ? EXIT_SUCCESS : EXIT_FAILURE;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "sampling: %s\n", error.what());
        return EXIT_FAILURE;
    }
}
