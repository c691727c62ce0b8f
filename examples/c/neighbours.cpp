// The pairs of a block file that touch or overlap, each with the number of its contacts, exactly and in double.
#include "rockproof.h"
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

template <auto release> struct Release {
    template <class T> void operator()(T *handle) const { release(handle); }
};
using Block = std::unique_ptr<RockproofBlock, Release<rockproof_block_free>>;
using Contacts = std::unique_ptr<RockproofContacts, Release<rockproof_contacts_free>>;
using Distance = std::unique_ptr<RockproofDistance, Release<rockproof_distance_free>>;
using Model = std::unique_ptr<RockproofModel, Release<rockproof_model_free>>;

template <class Handle, class T> Handle taken(T *handle) {
    if (handle == nullptr) {
        throw std::runtime_error(rockproof_last_error());
    }
    return Handle(handle);
}

int main(int count, char **arguments) try {
    if (count != 2) {
        std::fprintf(stderr, "usage: %s FILE\n", arguments[0]);
        return 2;
    }
    const auto model = taken<Model>(rockproof_model_load(arguments[1], -1.0, -1.0));
    std::vector<Block> blocks;
    for (size_t i = 0; i < rockproof_model_block_count(model.get()); i++) {
        blocks.push_back(taken<Block>(rockproof_model_block(model.get(), i)));
    }
    for (size_t i = 0; i < blocks.size(); i++) {
        for (size_t j = i + 1; j < blocks.size(); j++) {
            const auto *a = blocks[i].get(), *b = blocks[j].get();
            const auto distance = taken<Distance>(rockproof_separation(a, b));
            if (rockproof_distance_sign(distance.get()) > 0) {
                continue;
            }
            const auto exact = taken<Contacts>(rockproof_classify(a, b, nullptr, ROCKPROOF_EXACT));
            const auto floats = taken<Contacts>(rockproof_classify(a, b, nullptr, ROCKPROOF_F64));
            std::printf("%zu and %zu: %g m, %zu contacts, in double %zu\n", i, j, rockproof_distance_nearest(distance.get()),
                        rockproof_contacts_count(exact.get()), rockproof_contacts_count(floats.get()));
        }
    }
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
