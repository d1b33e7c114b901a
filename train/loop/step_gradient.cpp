#include "train/loop/step_gradient.h"

#include <cmath>
#include <string>

#include "lte/base/check.h"

namespace lte::train {

StepGradient step_gradient(const std::vector<Example>& examples, int64_t step,
                           SceneGradients* gradients, Optimizer* optimizer) {
  optimizer->zero_gradients();
  StepGradient out;
  out.loss = gradients->accumulate(examples, step + 1);
  out.norm = optimizer->gradient_norm();
  return out;
}

void fail_on_gradient(const std::vector<Example>& examples, int64_t step, SceneGradients* gradients,
                      Optimizer* optimizer) {
  // The scenes' gradients were added up: only now is it worth asking which one it was.
  std::string culprits;
  for (const Example& example : examples) {
    optimizer->zero_gradients();
    gradients->accumulate_alone(example, step + 1);
    if (!std::isfinite(optimizer->gradient_norm()))
      culprits += (culprits.empty() ? "" : ", ") + example.scene;
  }
  if (culprits.empty()) culprits = examples.front().scene + " and its batch mates together";
  throw Error(
      concat("step ", step + 1, ": scene ", culprits,
             ": the gradient is not finite; no update was made, the last checkpoint stays"));
}

}  // namespace lte::train
