// SPDX-License-Identifier: MIT
#include "AnimGraphNode_SpherechainResponse.h"

#include "Modules/ModuleManager.h"

FText UAnimGraphNode_SpherechainResponse::GetNodeTitle(ENodeTitleType::Type TitleType) const
{
	return FText::FromString(TEXT("Spherechain Response"));
}

FText UAnimGraphNode_SpherechainResponse::GetTooltipText() const { return FText::FromString(TEXT("Turns arms and hands out of the body")); }

FString UAnimGraphNode_SpherechainResponse::GetNodeCategory() const { return TEXT("Spherechain"); }

IMPLEMENT_MODULE(FDefaultModuleImpl, SpherechainEditor)
