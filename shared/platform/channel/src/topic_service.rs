//! Opening of publish-subscribe services with the limits of their topics.

use crate::Error;
use crate::domain::{Domain, Service};
use crate::service_creation::open_or_create;
use crate::topic::{Limits, Overflow, Topic};
use iceoryx2::prelude::{MessagingPattern, ServiceName};
use iceoryx2::service::builder::publish_subscribe::{
    PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;

pub(crate) type IoxService<T> = PortFactory<Service, [<T as Topic>::Item], <T as Topic>::Header>;

/// Opens a topic's service with its limits, or creates it.
pub(crate) fn open_service<T: Topic>(domain: &Domain) -> Result<IoxService<T>, Error> {
    let Limits {
        publishers,
        buffer,
        borrowed,
        history,
        ..
    } = T::LIMITS;
    let subscribers = T::LIMITS.all_subscribers(domain.guest_places());
    let name: ServiceName = T::NAME
        .try_into()
        .map_err(|e| Error::transport("name", T::NAME, e))?;
    let open = || {
        domain
            .node()
            .service_builder(&name)
            .publish_subscribe::<[T::Item]>()
            .user_header::<T::Header>()
            .max_publishers(publishers)
            .max_subscribers(subscribers)
            .max_nodes(publishers + subscribers)
            .subscriber_max_buffer_size(buffer)
            .subscriber_max_borrowed_samples(borrowed)
            .history_size(history)
            .enable_safe_overflow(T::Overflow::DROPS_OLDEST)
            .open_or_create()
    };
    let pattern = MessagingPattern::PublishSubscribe;
    open_or_create(domain, &name, pattern, open, |error| {
        let hangs = PublishSubscribeOpenError::HangsInCreation;
        *error == PublishSubscribeOpenOrCreateError::PublishSubscribeOpenError(hangs)
    })
    .map_err(|error| open_failed::<T>(domain, error))
}

fn open_failed<T: Topic>(domain: &Domain, error: PublishSubscribeOpenOrCreateError) -> Error {
    use PublishSubscribeOpenError as Open;
    match error {
        PublishSubscribeOpenOrCreateError::PublishSubscribeOpenError(
            Open::IncompatibleTypes
            | Open::IncompatibleMessagingPattern
            | Open::IncompatibleAttributes
            | Open::IncompatibleOverflowBehavior
            | Open::DoesNotSupportRequestedMinBufferSize
            | Open::DoesNotSupportRequestedMinHistorySize
            | Open::DoesNotSupportRequestedMinSubscriberBorrowedSamples
            | Open::DoesNotSupportRequestedAmountOfPublishers
            | Open::DoesNotSupportRequestedAmountOfSubscribers
            | Open::DoesNotSupportRequestedAmountOfNodes,
        ) => Error::OtherVersion {
            service: T::NAME,
            domain: domain.name().to_string(),
        },
        other => Error::transport("open", T::NAME, other),
    }
}
