// The query decoder's layers, forwards and backwards, and what a run of queries sums up of the
// gradients by their weights.
#pragma once

#include <vector>

#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/ops/decoder_weights.h"

namespace lte::ops {

/// A layer of the decoder.
struct DecoderBlock {
  PackedNorm norm1;
  Layer query, output;
  PackedNorm norm2;
  Perceptron ffn;

  explicit DecoderBlock(const LayerWeights& w)
      : norm1(w.norm1.gain, w.norm1.bias),
        query(w.query),
        output(w.output),
        norm2(w.norm2.gain, w.norm2.bias),
        ffn(w.ffn) {}
};

struct DecoderNetwork {
  Perceptron point, gamma;
  std::vector<DecoderBlock> blocks;
  PackedNorm norm;
  Perceptron head;

  explicit DecoderNetwork(const DecoderWeights& w)
      : point(w.point), gamma(w.gamma), norm(w.norm.gain, w.norm.bias), head(w.head) {
    for (const LayerWeights& layer : w.layers) blocks.emplace_back(layer);
  }
};

/// Gradients by the weights of a run of queries.
struct DecoderSums {
  struct OfBlock {
    NormSums norm1;
    LinearGradient query, output;
    NormSums norm2;
    PerceptronSums ffn;

    explicit OfBlock(const DecoderBlock& b)
        : norm1(b.norm1),
          query(b.query.forward),
          output(b.output.forward),
          norm2(b.norm2),
          ffn(b.ffn) {}
  };
  PerceptronSums point, gamma;
  std::vector<OfBlock> blocks;
  NormSums norm;
  PerceptronSums head;

  explicit DecoderSums(const DecoderNetwork& net)
      : point(net.point), gamma(net.gamma), norm(net.norm), head(net.head) {
    for (const DecoderBlock& block : net.blocks) blocks.emplace_back(block);
  }
  void write(const DecoderWeights& to, bool add) const {
    point.write(to.point, add);
    gamma.write(to.gamma, add);
    for (size_t l = 0; l < blocks.size(); ++l) {
      blocks[l].norm1.write(to.layers[l].norm1, add);
      blocks[l].query.write(to.layers[l].query.weight, to.layers[l].query.bias, add);
      blocks[l].output.write(to.layers[l].output.weight, to.layers[l].output.bias, add);
      blocks[l].norm2.write(to.layers[l].norm2, add);
      blocks[l].ffn.write(to.layers[l].ffn, add);
    }
    norm.write(to.norm, add);
    head.write(to.head, add);
  }
};

}  // namespace lte::ops
