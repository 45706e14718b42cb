//! Request handler of the memory service.

use crate::request_router::RequestRouter;
use channel::control::{AnswerFuture, Handler};
use std::sync::Arc;

/// Handler that answers from the memories.
pub(crate) fn handler(router: RequestRouter) -> Handler {
    let router = Arc::new(router);
    Arc::new(move |command, user| -> AnswerFuture {
        let router = router.clone();
        Box::pin(async move { router.answer(command, user).await })
    })
}
