// A complete client for Rockproof in C++17, without other libraries: the separating axis theorem for two convex blocks, in doubles.
//
//     c++ -std=c++17 -O2 -o client examples/engines/client.cpp
//     rockproof campaign --engine-command "sat=./client"
//
// Replace `lie` by a call of your own code. One question a line on stdin, one answer a line on stdout; anything for people goes to
// stderr. For an engine in f32 name it `sat:f32` and read the numbers as they are: they are floats already.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// ---- JSON, as much as a question holds -------------------------------------------------------------------------------------

struct Json {
    enum Kind { nothing, number, text, list, object } kind = nothing;
    double value = 0;
    std::string characters;
    std::vector<Json> items;
    std::vector<std::string> keys;  // of items, in an object

    const Json& operator[](const char* key) const {
        for (std::size_t k = 0; k < keys.size(); ++k)
            if (keys[k] == key) return items[k];
        throw std::runtime_error(std::string("the question has no ") + key);
    }
};

class Reader {
public:
    explicit Reader(const std::string& line) : at(line.c_str()) {}

    Json read() {
        Json json = read_value();
        if (skip() != '\0') wrong("the end of the line");
        return json;
    }

private:
    const char* at;

    [[noreturn]] void wrong(const char* expected) const {
        throw std::runtime_error(std::string("expected ") + expected + " at: " + std::string(at).substr(0, 40));
    }

    char skip() {
        while (*at == ' ' || *at == '\t' || *at == '\r') ++at;
        return *at;
    }

    void take(char wanted) {
        const char name[] = {wanted, '\0'};
        if (skip() != wanted) wrong(name);
        ++at;
    }

    std::string read_text() {
        take('"');
        std::string text;
        while (*at != '"') {
            if (*at == '\0') wrong("a closing quote");
            if (*at == '\\' && *++at == '\0') wrong("a character after \\");
            text += *at++;
        }
        ++at;
        return text;
    }

    Json read_value() {
        Json json;
        switch (skip()) {
        case '{':
        case '[': {
            const bool is_object = *at == '{';
            const char close = is_object ? '}' : ']';
            json.kind = is_object ? Json::object : Json::list;
            ++at;
            while (skip() != close) {
                if (!json.items.empty()) take(',');
                if (is_object) {
                    json.keys.push_back(read_text());
                    take(':');
                }
                json.items.push_back(read_value());
            }
            ++at;
            return json;
        }
        case '"':
            json.kind = Json::text;
            json.characters = read_text();
            return json;
        default: {
            // strtod gives the nearest double, which for a question's numbers is the number meant, bit for bit.
            char* end = nullptr;
            json.kind = Json::number;
            json.value = std::strtod(at, &end);
            if (end == at) wrong("a number");
            at = end;
            return json;
        }
        }
    }
};

// ---- Blocks ----------------------------------------------------------------------------------------------------------------

using Vector = std::array<double, 3>;

struct Block {
    std::vector<Vector> vertices;
    std::vector<std::vector<std::size_t>> faces;  // counter-clockwise from outside
    bool convex = true;
};

Vector minus(const Vector& p, const Vector& q) { return {p[0] - q[0], p[1] - q[1], p[2] - q[2]}; }
double dot(const Vector& p, const Vector& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }
Vector cross(const Vector& p, const Vector& q) {
    return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

Block block(const Json& json) {
    Block block;
    for (const Json& v : json["vertices"].items) {
        if (v.items.size() != 3) throw std::runtime_error("a vertex has three coordinates");
        block.vertices.push_back({v.items[0].value, v.items[1].value, v.items[2].value});
    }
    for (const Json& f : json["faces"].items) {
        block.faces.emplace_back();
        for (const Json& v : f.items) {
            if (!(v.value >= 0 && v.value < double(block.vertices.size()))) throw std::runtime_error("no such vertex");
            block.faces.back().push_back(std::size_t(v.value));
        }
        if (f.items.size() < 3) throw std::runtime_error("a face has three vertices or more");
    }
    block.convex = json["reflex"].items.empty();
    return block;
}

// ---- Your code comes here --------------------------------------------------------------------------------------------------

struct Said {
    const char* state;
    bool measured;  // whether gap and normal are told
    double gap_m;
    Vector normal;  // in which A leaves B
};

std::vector<Vector> edges(const Block& block) {
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& face : block.faces)
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::size_t p = face[k], q = face[(k + 1) % face.size()];
            pairs.insert({std::min(p, q), std::max(p, q)});
        }
    std::vector<Vector> directions;
    for (const auto& [p, q] : pairs) directions.push_back(minus(block.vertices[q], block.vertices[p]));
    return directions;
}

void add_normals(const Block& block, std::vector<Vector>& axes) {
    for (const auto& face : block.faces) {
        const Vector &p = block.vertices[face[0]], &q = block.vertices[face[1]], &r = block.vertices[face[2]];
        axes.push_back(cross(minus(q, p), minus(r, q)));
    }
}

// How two convex blocks lie: the widest slab between them, or the thinnest overlap, over all axes.
Said lie(const Block& a, const Block& b) {
    std::vector<Vector> axes;
    add_normals(a, axes);
    add_normals(b, axes);
    const std::vector<Vector> of_b = edges(b);
    for (const Vector& d : edges(a))
        for (const Vector& e : of_b) axes.push_back(cross(d, e));
    double widest = -HUGE_VAL;
    Vector normal{};
    for (const Vector& axis : axes) {
        const double length = std::sqrt(dot(axis, axis));
        if (!(length >= 1e-12)) continue;  // parallel edges: a tolerance of the kind a campaign finds
        for (const double sign : {1.0, -1.0}) {
            const Vector n = {sign * axis[0] / length, sign * axis[1] / length, sign * axis[2] / length};
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (const Vector& p : a.vertices) low = std::min(low, dot(n, p));
            for (const Vector& q : b.vertices) high = std::max(high, dot(n, q));
            if (low - high > widest) {
                widest = low - high;
                normal = n;
            }
        }
    }
    if (widest > 0) return {"apart", false, 0, {}};  // between two corners the slab is not the distance, so no gap is claimed
    return {widest == 0 ? "touching" : "overlapping", std::isfinite(widest), widest, normal};
}

// ---- The conversation ------------------------------------------------------------------------------------------------------

int main() {
    std::string line;
    while (std::getline(std::cin, line)) {
        try {
            const Json question = Reader(line).read();
            const Block a = block(question["a"]), b = block(question["b"]);
            std::printf("{\"id\":%.0f,", question["id"].value);
            if (!a.convex || !b.convex) {
                std::printf("\"unsupported\":\"a block is concave\"}\n");
            } else {
                const Said said = lie(a, b);
                std::printf("\"state\":\"%s\"", said.state);
                if (said.measured) {
                    const Vector& n = said.normal;
                    std::printf(",\"gap_m\":%.17g,\"normal\":[%.17g,%.17g,%.17g]", said.gap_m, n[0], n[1], n[2]);
                }
                std::printf("}\n");
            }
            std::fflush(stdout);
        } catch (const std::exception& why) {
            std::fprintf(stderr, "%s\n", why.what());
            return 1;
        }
    }
}
