#pragma once

#include <systemc>

namespace stereotlm {

// The protocol of the streams between the stages of a pipeline: a stage pushes one beat into the next, which
// takes it in the same cycle. There is no back pressure; who may push when is decided by the pipeline's
// control.
template <class Beat>
class StreamIf : public virtual sc_core::sc_interface {
 public:
  virtual void push(const Beat& beat) = 0;
};

// The sockets of a stream. An output binds to one input: `stage.pixels_out.bind(next.pixels_in)`.
template <class Beat>
using StreamOut = sc_core::sc_port<StreamIf<Beat>>;

// Calls a member function of its owner for each beat.
template <class Beat, class Owner, void (Owner::*Take)(const Beat&)>
class StreamIn : public sc_core::sc_export<StreamIf<Beat>> {
 public:
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
