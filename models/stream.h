#pragma once

#include <systemc>

namespace stereotlm {

// A stream between two stages of a pipeline. A stage pushes one beat into the next stage, which takes it in
// the same cycle. There is no back pressure: the pipeline's control decides which stage pushes in a cycle.
template <class Beat>
class StreamIf : public virtual sc_core::sc_interface {
 public:
  virtual void push(const Beat& beat) = 0;  // takes a beat, now
};

// The output of a stream. It binds to one input: `stage.pixels_out.bind(next.pixels_in)`.
template <class Beat>
using StreamOut = sc_core::sc_port<StreamIf<Beat>>;

// The input of a stream. It calls a member function of its owner for each beat.
template <class Beat, class Owner, void (Owner::*Take)(const Beat&)>
class StreamIn : public sc_core::sc_export<StreamIf<Beat>> {
 public:
  // `owner`: the module of the member function.
  StreamIn(const char* name, Owner* owner) : sc_core::sc_export<StreamIf<Beat>>(name), receiver_(owner) {
    this->bind(receiver_);
  }

 private:
  class Receiver : public StreamIf<Beat> {
   public:
    explicit Receiver(Owner* owner) : owner_(owner) {}
    void push(const Beat& beat) override { (owner_->*Take)(beat); }

   private:
    Owner* owner_;
  };
  Receiver receiver_;
};

}  // namespace stereotlm
