//! Publishers of the simulated person and the ground truth.

use crate::wire_conversion;
use channel::topic::{PersonBodies, TrueMasks, TrueObjects};
use channel::{Domain, Error, Publisher};
use message::{FrameHeader, MaskPixel, PersonBody, TruthHeader};
use simulated_world::{ObjectTruth, World};

/// Publishers of all topics but the point cloud and the state of the arm.
pub(crate) struct WorldPublishers {
    person: Publisher<PersonBodies>,
    objects: Publisher<TrueObjects>,
    mask: Publisher<TrueMasks>,
}

impl WorldPublishers {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            person: Publisher::new(domain)?,
            objects: Publisher::new(domain)?,
            mask: Publisher::new(domain)?,
        })
    }

    /// Shared memory reserved by the publishers, bytes.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.person.reservation().bytes()
            + self.objects.reservation().bytes()
            + self.mask.reservation().bytes()
    }

    /// Publishes the people's bodies of a frame.
    pub(crate) fn person(&mut self, header: &FrameHeader, world: &World) -> Result<(), Error> {
        let body = PersonBody {
            stamp_ns: header.capture_stamp_ns,
            ..PersonBody::default()
        };
        let capsules = wire_conversion::capsules(&world.person_capsules());
        self.person.send_copy(body, &capsules)
    }

    /// Publishes the ground truth of a frame that was sent with this header.
    pub(crate) fn truth(
        &mut self,
        header: &FrameHeader,
        objects: &[ObjectTruth],
        mask: &[u16],
    ) -> Result<(), Error> {
        let truth = TruthHeader {
            session: header.session,
            sequence: header.sequence,
            capture_ns: header.capture_stamp_ns,
            ..TruthHeader::default()
        };
        let wire: Vec<_> = objects.iter().map(wire_conversion::true_object).collect();
        self.objects.send_copy(truth, &wire)?;
        if !self.mask.has_subscribers() {
            return Ok(());
        }
        let mut loan = self.mask.loan(mask.len())?;
        *loan.header_mut() = truth;
        for (pixel, &object) in loan.items_mut().iter_mut().zip(mask) {
            *pixel = MaskPixel(object);
        }
        self.mask.send(loan)
    }
}
