// SPDX-License-Identifier: MIT
// The animation node as animation blueprints show it.
#pragma once

#include "AnimGraphNode_Base.h"
#include "AnimNode_SpherechainResponse.h"
#include "CoreMinimal.h"
#include "AnimGraphNode_SpherechainResponse.generated.h"

UCLASS()
class UAnimGraphNode_SpherechainResponse : public UAnimGraphNode_Base
{
	GENERATED_BODY()

	UPROPERTY(EditAnywhere, Category = Settings)
	FAnimNode_SpherechainResponse Node;

public:
	virtual FText GetNodeTitle(ENodeTitleType::Type TitleType) const override;
	virtual FText GetTooltipText() const override;
	virtual FString GetNodeCategory() const override;
};
