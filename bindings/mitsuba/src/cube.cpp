#include "cube.h"

#include <map>
#include <mutex>

namespace upglow_mitsuba {

Cube::Cube(const std::string &path) : m_path(path) {
    expect_ok(upglow_cube_open(path.c_str(), &m_cube));
    expect_ok(upglow_cube_facts(m_cube, &m_facts));
}

std::shared_ptr<const Cube> Cube::load(const std::string &path) {
    static std::mutex mutex;
    static std::map<std::string, std::weak_ptr<const Cube>> loaded;
    std::lock_guard<std::mutex> guard(mutex);
    std::weak_ptr<const Cube> &place = loaded[path];
    if (std::shared_ptr<const Cube> cube = place.lock())
        return cube;
    std::shared_ptr<const Cube> cube(new Cube(path));
    place = cube;
    return cube;
}

UpglowMaterial Cube::look_up(const std::array<float, 3> &rgb) const {
    UpglowMaterial material;
    expect_ok(upglow_look_up(m_cube, rgb.data(), &material));
    return material;
}

float reflectance_of(const UpglowMaterial &material, float lambda_nm) {
    float reflectance;
    expect_ok(upglow_reflectance(&material, lambda_nm, &reflectance));
    return reflectance;
}

}  // namespace upglow_mitsuba
